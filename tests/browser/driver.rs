//! A browser without a window, and what a user does in it.

use headless_chrome::browser::tab::point::Point;
use headless_chrome::protocol::cdp::types::Event;
use headless_chrome::protocol::cdp::{Emulation, Input, Page};
use headless_chrome::{Browser, LaunchOptions, Tab};
use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Names of programs that will do.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// No graphics card, no network, no first steps.
const ARGUMENTS: [&str; 5] = [
    "--disable-gpu",
    "--disable-quic",
    "--disable-component-update",
    "--hide-scrollbars",
    "--mute-audio",
];

/// A page that is open.
pub(crate) struct Open {
    pub(crate) tab: Arc<Tab>,
    /// What the page has complained about.
    complaints: Arc<Mutex<Vec<String>>>,
    // The browser ends with it, and then its folder.
    _browser: Browser,
    _profile: TempDir,
}

/// A browser of this machine. Without one the test says so and is over, unless the environment demands it.
pub(crate) fn find() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path)
        .flat_map(|folder| NAMES.map(|name| folder.join(name)))
        .find(|program| program.is_file());
    if found.is_none() {
        let demanded = std::env::var("LUMIDUCT_BROWSER").is_ok_and(|wish| wish == "required");
        assert!(!demanded, "no browser: none of {NAMES:?} is on the path");
        #[allow(clippy::print_stderr, reason = "whoever runs the tests has to know")]
        {
            eprintln!("skipped the browser: none of {NAMES:?} is on the path");
        }
    }
    found
}

impl Open {
    /// Opens a file.
    pub(crate) fn new(program: &Path, file: &Path) -> Self {
        let profile = tempfile::tempdir().unwrap();
        let options = LaunchOptions::default_builder()
            .path(Some(program.to_path_buf()))
            .user_data_dir(Some(profile.path().to_path_buf()))
            .sandbox(false)
            .window_size(Some((1400, 1000)))
            .args(ARGUMENTS.iter().map(OsStr::new).collect())
            .build()
            .unwrap();
        let browser = Browser::new(options).unwrap();
        let tab = browser.new_tab().unwrap();
        let complaints = Arc::new(Mutex::new(Vec::new()));
        let heard = Arc::clone(&complaints);
        tab.add_event_listener(Arc::new(move |event: &Event| {
            let complaint = match event {
                Event::RuntimeExceptionThrown(thrown) => {
                    format!("{:?}", thrown.params.exception_details)
                }
                Event::LogEntryAdded(entry) => entry.params.entry.text.clone(),
                Event::RuntimeConsoleAPICalled(called) => format!("{:?}", called.params.args),
                _ => return,
            };
            heard.lock().unwrap().push(complaint);
        }))
        .unwrap();
        tab.enable_runtime().unwrap();
        tab.enable_log().unwrap();
        tab.navigate_to(&format!("file://{}", file.display())).unwrap();
        tab.wait_until_navigated().unwrap();
        Self { tab, complaints, _browser: browser, _profile: profile }
    }

    /// What an expression of the page comes to.
    pub(crate) fn ask(&self, expression: &str) -> Value {
        let wrapped = format!("JSON.stringify({expression}) ?? 'null'");
        let answer = self.tab.evaluate(&wrapped, false).unwrap();
        serde_json::from_str(answer.value.unwrap().as_str().unwrap()).unwrap()
    }

    /// The same as text.
    pub(crate) fn text(&self, expression: &str) -> String {
        self.ask(expression).as_str().unwrap().to_owned()
    }

    /// Waits until an expression is true: pages draw when they come to it.
    pub(crate) fn expect(&self, expression: &str) {
        let start = Instant::now();
        while self.ask(expression) != Value::Bool(true) {
            assert!(start.elapsed() < Duration::from_secs(5), "never true: {expression}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// A place at a share of the width and height of an element, brought into view.
    pub(crate) fn place(&self, element: &str, share: [f64; 2]) -> Point {
        let box_of = format!(
            "(() => {{ const e = {element}; e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
             const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; }})()"
        );
        let found = self.ask(&box_of);
        let [left, top, width, height] = [0, 1, 2, 3].map(|i| found[i].as_f64().unwrap());
        Point { x: left + share[0] * width, y: top + share[1] * height }
    }

    /// Moves the pointer over an element.
    pub(crate) fn point_at(&self, element: &str, share: [f64; 2]) {
        self.tab.move_mouse_to_point(self.place(element, share)).unwrap();
    }

    /// Clicks on an element.
    pub(crate) fn click(&self, element: &str) {
        self.tab.click_point(self.place(element, [0.5, 0.5])).unwrap();
    }

    /// Drags over an element from one place to another.
    pub(crate) fn drag(&self, element: &str, from: [f64; 2], to: [f64; 2]) {
        let start = self.place(element, from);
        let end = self.place(element, to);
        let middle = Point { x: 0.5 * (start.x + end.x), y: 0.5 * (start.y + end.y) };
        self.mouse(Input::DispatchMouseEventTypeOption::MousePressed, start);
        self.mouse(Input::DispatchMouseEventTypeOption::MouseMoved, middle);
        self.mouse(Input::DispatchMouseEventTypeOption::MouseMoved, end);
        self.mouse(Input::DispatchMouseEventTypeOption::MouseReleased, end);
    }

    fn mouse(&self, kind: Input::DispatchMouseEventTypeOption, at: Point) {
        let event = Input::DispatchMouseEvent {
            Type: kind,
            x: at.x,
            y: at.y,
            button: Some(Input::MouseButton::Left),
            buttons: Some(1),
            click_count: Some(1),
            modifiers: None,
            timestamp: None,
            delta_x: None,
            delta_y: None,
            pointer_Type: None,
            force: None,
            tangential_pressure: None,
            tilt_x: None,
            tilt_y: None,
            twist: None,
        };
        self.tab.call_method(event).unwrap();
    }

    /// The page with a wish for light or dark.
    pub(crate) fn prefer(&self, scheme: &str) {
        let feature = Emulation::MediaFeature {
            name: "prefers-color-scheme".to_owned(),
            value: scheme.to_owned(),
        };
        let wish = Emulation::SetEmulatedMedia { media: None, features: Some(vec![feature]) };
        self.tab.call_method(wish).unwrap();
    }

    /// A picture of what is in view, decoded: width and RGB or RGBA bytes.
    pub(crate) fn picture(&self, keep: &Path) -> Vec<[u8; 3]> {
        let format = Page::CaptureScreenshotFormatOption::Png;
        let file = self.tab.capture_screenshot(format, None, None, true).unwrap();
        std::fs::write(keep, &file).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        let step = info.color_type.samples();
        pixels.chunks_exact(step).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
    }

    /// Fails where the page has complained.
    pub(crate) fn expect_no_complaints(&self) {
        let complaints = self.complaints.lock().unwrap();
        assert!(complaints.is_empty(), "{complaints:#?}");
    }
}
