use bevy::{ecs::schedule::SingleThreadedExecutor, prelude::*};

fn tick_on_one_thread(app: &mut App) {
    app.edit_schedule(FixedUpdate, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
    });
}
