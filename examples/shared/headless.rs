//! An example without a window: as fast as it can, with a report and a picture.

use std::{
    collections::VecDeque,
    fmt, fs,
    io::{IsTerminal, stderr},
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use bevy::{
    prelude::*,
    render::{
        render_resource::TextureFormat,
        renderer::RenderAdapterInfo,
        view::screenshot::{Captured, Screenshot, ScreenshotCaptured},
    },
    time::TimeUpdateStrategy,
};
use serde::Serialize;

use super::{
    measured::{Figures, MeasuringPlugin},
    pixels::Pixels,
    stage::{Grid, Shot},
    start::{Example, Options},
    view::View,
};

/// Of a picture, and of a film's frames: these are put together, with colours that they share.
const PICTURE: Format = Format {
    size: [800, 450],
    colors: Some(256),
    is_warm: false,
};
const FRAME: Format = Format {
    size: [480, 270],
    colors: None,
    is_warm: false,
};

/// Frames that a renderer gets to finish a picture in.
const FRAMES_FOR_A_PICTURE: usize = 60;

/// How long an asset may take to load (s).
const PATIENCE: u64 = 20;

/// Fixed ticks that share one update of the app, and with it one idle frame of the renderer: 0.25 s, the most
/// that Bevy's virtual time takes at once.
const TICKS_AN_UPDATE: u64 = 16;

/// In an app in which frames move what cloth hangs from, as animations do: each tick has a frame of its own.
#[derive(Resource, Default)]
pub struct TickByTick;

/// An app and how far it has come.
pub struct Run {
    pub app: App,
    pub example: Example,
    pub options: Options,
    view: View,
    film: Film,
    /// In all.
    pub ticks: u64,
    /// How long what is done took, without pictures (s).
    pub wall_seconds: f64,
    done: u64,
    is_ready: bool,
}

impl Run {
    /// Of an example, for as long as the options say. Its report may add to the app before the first tick.
    pub fn new(example: Example, view: View, grid: Grid, options: Options) -> Self {
        let mut app = App::new();
        app.add_plugins((view.plugins(example.title), MeasuringPlugin))
            .insert_resource(grid);
        (example.scene)(&mut app);
        Self {
            ticks: ticks_in(&app, options.seconds).max(1),
            film: Film::of(&app, &options),
            app,
            example,
            options,
            view,
            wall_seconds: 0.0,
            done: 0,
            is_ready: false,
        }
    }

    /// Before the first tick.
    fn get_ready(&mut self) {
        if !self.is_ready {
            self.is_ready = true;
            self.app.finish();
            self.app.cleanup();
            self.wait_for_assets();
        }
    }

    /// Lets time stand still until all meshes are there, and the scenes of files.
    fn wait_for_assets(&mut self) {
        self.app
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
        for _ in 0..PATIENCE * 100 {
            self.app.update();
            let world = self.app.world_mut();
            let mut meshes = world.query::<&Mesh3d>();
            let handles: Vec<Handle<Mesh>> =
                meshes.iter(world).map(|mesh| mesh.0.clone()).collect();
            let meshes = world.resource::<Assets<Mesh>>();
            let has_meshes = handles.iter().all(|handle| meshes.contains(handle));
            let mut scenes = world.query_filtered::<Has<Children>, With<WorldAssetRoot>>();
            if has_meshes && scenes.iter(world).all(|is_there| is_there) {
                return;
            }
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Goes on to the end.
    pub fn finish(&mut self) -> Figures {
        self.until(self.ticks);
        Figures::of(self)
    }

    /// Goes on until this many ticks are done, or all of them. Films on the way.
    pub fn until(&mut self, ticks: u64) {
        self.get_ready();
        let ticks = ticks.min(self.ticks);
        while let Some(frame) = self.film.pop_until(ticks) {
            self.advance(frame.tick);
            self.save_frame(&frame.file);
        }
        self.advance(ticks);
    }

    /// Fixed ticks in this many seconds.
    pub fn ticks_in(&self, seconds: f64) -> u64 {
        ticks_in(&self.app, seconds)
    }

    /// Goes on until the example's picture is due, and draws it.
    pub fn picture(&mut self) -> Picture {
        self.until(self.ticks_in(self.example.drawn_at));
        self.take_picture(&format!("{}.png", self.example.name))
    }

    fn advance(&mut self, ticks: u64) {
        let start = Instant::now();
        while self.done < ticks {
            let together = match self.app.world().contains_resource::<TickByTick>() {
                true => 1,
                false => (ticks - self.done).min(TICKS_AN_UPDATE) as u32,
            };
            self.app
                .insert_resource(TimeUpdateStrategy::FixedTimesteps(together));
            self.app.update();
            let time = self.app.world().resource::<Time<Fixed>>();
            self.done = ticks_in(&self.app, time.elapsed_secs_f64());
            say(&format!("{} of {} ticks", self.done, self.ticks));
        }
        self.wall_seconds += start.elapsed().as_secs_f64();
    }

    /// Draws one frame and saves it, while time stands still.
    fn take_picture(&mut self, file: &str) -> Picture {
        say("");
        let drawn = self.draw(PICTURE, file);
        let adapter = self.app.world().get_resource::<RenderAdapterInfo>();
        let (picture, no_picture) = match drawn {
            Ok(path) => (Some(path), None),
            Err(why) => (None, Some(why)),
        };
        Picture {
            picture,
            no_picture,
            adapter: adapter.map(|info| info.name.clone()),
        }
    }

    /// Draws the film's next frame.
    fn save_frame(&mut self, file: &str) {
        let format = self.film.format;
        self.film.format.is_warm = true;
        if let Err(why) = self.draw(format, file) {
            eprintln!("{file}: {why}");
            self.film.frames.clear();
        }
    }

    fn draw(&mut self, format: Format, file: &str) -> Result<PathBuf, String> {
        if self.view == View::Offscreen {
            let shot = self.example.shot;
            draw(&mut self.app, shot, format, &self.options.out, file)
        } else {
            Err("no graphics adapter found".into())
        }
    }
}

/// Says on a terminal how far the run is, in place of what was said before.
fn say(how_far: &str) {
    if stderr().is_terminal() {
        eprint!("\r{how_far:30}\r");
    }
}

/// The frames of a film that are still to be drawn, from the first, and how.
struct Film {
    format: Format,
    frames: VecDeque<Frame>,
}

struct Frame {
    tick: u64,
    file: String,
}

impl Film {
    fn of(app: &App, options: &Options) -> Self {
        let length = options.to - options.from;
        let frame = |number: u32| {
            let part = f64::from(number) / f64::from(options.frames);
            Frame {
                tick: ticks_in(app, options.from + part * length),
                file: format!("frame-{number:03}.png"),
            }
        };
        Self {
            format: FRAME,
            frames: (0..options.frames).map(frame).collect(),
        }
    }

    /// The next frame, if it is to be drawn before more ticks than these are done.
    fn pop_until(&mut self, ticks: u64) -> Option<Frame> {
        self.frames.pop_front_if(|frame| frame.tick <= ticks)
    }
}

/// How a picture is drawn.
#[derive(Clone, Copy)]
struct Format {
    /// Width and height (pixels).
    size: [u32; 2],
    /// How many colours it has at most: all unless given.
    colors: Option<usize>,
    /// Whether assets, pipelines and shadows are ready, as after another picture.
    is_warm: bool,
}

fn ticks_in(app: &App, seconds: f64) -> u64 {
    let timestep = app.world().resource::<Time<Fixed>>().timestep();
    (seconds / timestep.as_secs_f64()).round() as u64
}

/// Whether the picture was drawn, and where it is.
#[derive(Serialize, Default)]
pub struct Picture {
    picture: Option<PathBuf>,
    /// Why there is no picture.
    no_picture: Option<String>,
    adapter: Option<String>,
}

impl fmt::Display for Picture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.picture, &self.adapter, &self.no_picture) {
            (Some(path), Some(adapter), _) => write!(f, "{}, drawn by {adapter}", path.display()),
            (_, _, Some(why)) => write!(f, "none: {why}"),
            _ => write!(f, "none"),
        }
    }
}

fn draw(
    app: &mut App,
    shot: Shot,
    format: Format,
    out: &Path,
    file: &str,
) -> Result<PathBuf, String> {
    let path = out.join(file);
    fs::create_dir_all(out)
        .map_err(|error| format!("{} could not be made: {error}", out.display()))?;
    // One left by an earlier run must not pass for this one's.
    if path.exists() {
        fs::remove_file(&path)
            .map_err(|error| format!("{} could not be replaced: {error}", path.display()))?;
    }
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    let mut target = |[width, height]: [u32; 2]| {
        let target = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
        app.world_mut().resource_mut::<Assets<Image>>().add(target)
    };
    let [small, large] = [[160, 90], format.size.map(|pixels| 2 * pixels)].map(&mut target);
    // The picture is drawn at twice its size, which smooths edges better than samples do.
    let camera = |target| (shot.camera(Some(target)), Msaa::Off);
    // Lines are as wide in the picture as in a window.
    let mut gizmos = app.world_mut().resource_mut::<GizmoConfigStore>();
    for (_, config, _) in gizmos.iter_mut() {
        config.line.width *= 2.0;
    }
    if !format.is_warm {
        // A few frames, small ones, for all to be ready.
        let tiny = app.world_mut().spawn(camera(small)).id();
        (0..8).for_each(|_| app.update());
        app.world_mut().despawn(tiny);
    }
    let camera = app.world_mut().spawn(camera(large.clone())).id();
    // A camera's own light, its sky, is there in its second frame.
    app.update();
    let screenshot = app
        .world_mut()
        .spawn(Screenshot::image(large))
        .observe(save_to(path.clone(), format))
        .id();
    app.update();
    // What is drawn is on its way.
    app.world_mut().despawn(camera);
    for _ in 0..FRAMES_FOR_A_PICTURE {
        app.update();
        let world = app.world();
        if world.get_entity(screenshot).is_err() || world.get::<Captured>(screenshot).is_some() {
            break;
        }
    }
    let mut gizmos = app.world_mut().resource_mut::<GizmoConfigStore>();
    for (_, config, _) in gizmos.iter_mut() {
        config.line.width /= 2.0;
    }
    if path.is_file() {
        Ok(path)
    } else {
        Err(format!("{} could not be drawn or saved", path.display()))
    }
}

/// Saves what is drawn, at half its size.
fn save_to(path: PathBuf, format: Format) -> impl FnMut(On<ScreenshotCaptured>) {
    move |captured| {
        let bytes = captured.image.data.as_deref().unwrap_or_default();
        let rgb = bytes.chunks_exact(4).map(|at| [at[0], at[1], at[2]]);
        let drawn = Pixels {
            width: captured.image.width() as usize,
            height: captured.image.height() as usize,
            rgb: rgb.collect(),
        };
        let [width, height] = format.size.map(|side| side as usize);
        if let Err(why) = drawn.scaled(width, height).save(&path, format.colors) {
            error!("{why}");
        }
    }
}
