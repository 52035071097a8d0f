//! The count on screen, and the key that shows what it would be without.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_egui::{
    EguiContexts, EguiPrimaryContextPass,
    egui::{self, Align2, Color32, RichText},
};

use crate::scene::Crossings;

/// Shows the count.
pub struct ShownPlugin;

impl Plugin for ShownPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, press_key)
            .add_systems(EguiPrimaryContextPass, show);
    }
}

fn press_key(
    keys: Res<ButtonInput<KeyCode>>,
    cloths: Query<(Entity, Has<ClothSelfCollision>), With<Cloth>>,
    mut commands: Commands,
) {
    if !keys.just_pressed(KeyCode::KeyS) {
        return;
    }
    for (cloth, touches_itself) in &cloths {
        if touches_itself {
            commands.entity(cloth).remove::<ClothSelfCollision>();
        } else {
            commands.entity(cloth).insert(ClothSelfCollision::default());
        }
    }
}

fn show(mut contexts: EguiContexts, crossings: Res<Crossings>) -> Result {
    let text = format!("{} triangles pass through each other", crossings.now);
    let color = if crossings.now == 0 {
        Color32::from_rgb(20, 90, 140)
    } else {
        Color32::from_rgb(190, 80, 10)
    };
    egui::Area::new(egui::Id::new("fold: crossings"))
        .anchor(Align2::RIGHT_TOP, [-16.0, 16.0])
        .show(contexts.ctx_mut()?, |ui| {
            ui.label(RichText::new(text).size(20.0).color(color));
        });
    Ok(())
}
