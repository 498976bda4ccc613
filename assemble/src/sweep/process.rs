//! Runs a setting in a process of its own, to measure its time and memory, and keeps the result under the hash of
//! everything that it depends on, so that it is not run again.

use super::run::{Facts, PointLight, Run};
use super::setting::Setting;
use crate::output_file;
use csv::StringRecord;
use equilux_bake::monitor::Monitor;
use equilux_formats::fingerprint::Content;
use equilux_formats::{Error, Result, Rgb};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The interval at which a run is checked for its end.
const TICK: Duration = Duration::from_millis(5);

/// The inputs that all runs share.
pub struct Runner<'a> {
    /// The path of this program.
    pub program: PathBuf,
    /// The scene's file.
    pub scene: &'a Path,
    /// The points to compare light at.
    pub points: PathBuf,
    /// Options that every run gets.
    pub more: &'a [String],
    /// The folder of the sweep.
    pub folder: &'a Path,
    /// The content of program, scene and points.
    pub content: Content,
    /// When a run that has not ended is killed.
    pub deadline: Instant,
    /// Progress, and requests to stop.
    pub monitor: &'a Monitor,
}

/// How a run ended.
pub enum Ended {
    /// With a result.
    Done(Box<Run>),
    /// With an error, and this message.
    Failed(String),
    /// Killed, because the sweep was stopped.
    Stopped,
    /// Killed at the deadline.
    TimeUp,
}

impl Runner<'_> {
    /// The result of this setting that an earlier sweep kept, if any.
    pub fn kept(&self, setting: &Setting) -> Option<Run> {
        serde_json::from_slice(&fs::read(self.record(setting)).ok()?).ok()
    }

    /// Run this setting with an empty cache, and keep the result. Fails if the folder cannot be used.
    pub fn run(&self, setting: &Setting) -> Result<Ended> {
        let unusable = |error: std::io::Error| {
            let found = format!("cannot be used for a run ({error})");
            Error::new(self.folder, found, "a folder that can be written to", "choose another with --out DIR")
        };
        let place = tempfile::Builder::new().prefix("running-").tempdir_in(self.folder).map_err(unusable)?;
        let start = Instant::now();
        let running = self.start(setting, place.path()).map_err(unusable)?;
        let Some(success) = self.wait(running).map_err(unusable)? else {
            return Ok(if self.monitor.stopped() { Ended::Stopped } else { Ended::TimeUp });
        };
        let wall = start.elapsed().as_secs_f64();
        if self.monitor.stopped() {
            // The signal reached the run too, and may have ended it early.
            return Ok(Ended::Stopped);
        }
        if !success {
            let said = fs::read_to_string(place.path().join("stderr")).unwrap_or_default();
            return Ok(Ended::Failed(said.trim().to_owned()));
        }
        let (facts, light) = self.results(place.path())?;
        let run = Run { setting: setting.clone(), command: self.command(setting), wall, facts, light };
        let text = serde_json::to_vec(&run).expect("a run is plain data");
        output_file::write(&self.record(setting), |out| out.write_all(&text))?;
        Ok(Ended::Done(Box::new(run)))
    }

    /// The command line that repeats the run.
    pub fn command(&self, setting: &Setting) -> String {
        let arguments = setting.arguments(&self.scene.display().to_string());
        [vec!["assemble".to_owned()], arguments, self.more.to_vec()].concat().join(" ")
    }

    fn start(&self, setting: &Setting, place: &Path) -> std::io::Result<Child> {
        let mut command = Command::new(&self.program);
        command.args(setting.arguments(&self.scene.display().to_string())).args(self.more);
        command.arg("--json").arg("--out").arg(place.join("out")).arg("--points").arg(&self.points);
        if !setting.is_classic() {
            command.args(["--pictures", "none", "--exact-rows", "0", "--cache"]).arg(place.join("cache"));
        }
        command
            .stdin(Stdio::null())
            .stdout(File::create(place.join("stdout"))?)
            .stderr(File::create(place.join("stderr"))?)
            .spawn()
    }

    /// Whether the run ended well; none if it was killed.
    fn wait(&self, mut running: Child) -> std::io::Result<Option<bool>> {
        let mut shown = 0;
        let start = Instant::now();
        loop {
            if let Some(status) = running.try_wait()? {
                return Ok(Some(status.success()));
            }
            if self.monitor.stopped() || Instant::now() > self.deadline {
                running.kill()?;
                running.wait()?;
                return Ok(None);
            }
            std::thread::sleep(TICK);
            let tenths = (start.elapsed().as_secs_f64() * 10.0) as usize;
            self.monitor.advance(tenths - shown);
            shown = tenths;
        }
    }

    fn results(&self, place: &Path) -> Result<(Facts, Vec<Option<PointLight>>)> {
        let wrong = |path: &Path, found: String| {
            Error::new(path, found, "what this program writes", "report this as a bug of it")
        };
        let printed = place.join("stdout");
        let text = fs::read(&printed).map_err(|error| wrong(&printed, error.to_string()))?;
        let facts = serde_json::from_slice(&text).map_err(|error| wrong(&printed, error.to_string()))?;
        let scene = self.scene.file_stem().unwrap_or_default();
        let points = place.join("out").join(scene).join("points.csv");
        let unreadable = |error: csv::Error| wrong(&points, error.to_string());
        let mut table = csv::Reader::from_path(&points).map_err(unreadable)?;
        let lines: Vec<StringRecord> =
            table.records().collect::<std::result::Result<_, _>>().map_err(unreadable)?;
        let light: Option<Vec<_>> = lines.iter().map(point_light).collect();
        let light = light.ok_or_else(|| wrong(&points, "a line that is no point with its light".into()))?;
        if light.iter().all(Option::is_none) {
            let found = format!("none of its points lies on a surface of {}", self.scene.display());
            let remedy = "give the light of this very scene with --truth FILE.csv";
            return Err(Error::new(&self.points, found, "points on the scene's surfaces", remedy));
        }
        Ok((facts, light))
    }

    fn record(&self, setting: &Setting) -> PathBuf {
        let arguments = [setting.arguments("SCENE"), self.more.to_vec()].concat().join("\n");
        let digest = self.content.clone().bytes(arguments).digest().to_string();
        self.folder.join("runs").join(&digest[..32]).with_extension("json")
    }
}

/// The light on a line of points.csv, whose columns are place (3), normal (3), irradiance gathered (3), number of the
/// element, irradiance of the element (3). `Some(None)` where the point lies on no surface; none if the line is malformed.
fn point_light(line: &StringRecord) -> Option<Option<PointLight>> {
    let rgb = |first: usize| -> Option<Rgb> {
        let numbers: Option<Vec<f64>> =
            (first..first + 3).map(|place| line.get(place)?.parse().ok()).collect();
        numbers?.try_into().ok().map(Rgb)
    };
    if line.get(9)?.is_empty() {
        return Some(None);
    }
    Some(Some(PointLight { gathered: rgb(6)?, element: rgb(10)? }))
}
