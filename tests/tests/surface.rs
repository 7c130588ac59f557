//! Every name of the three headers of RoBIOS-7 and of `eye.py`, in programs that are generated from the signatures: each
//! function is called once in each use that the original allows, each constant and type is used.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use serde_json::Value;
use tests::{Ran, Scratch};

/// Functions of the headers of all years.
const FUNCTIONS: &str = "
int LCDPrintf(const char *format); int LCDSetPrintf(int row, int column, const char *format); int LCDClear(void);
int LCDSetPos(int row, int column); int LCDGetPos(int *row, int *column); int LCDSetColor(COLOR fg, COLOR bg);
int LCDSetFont(int font, int variation); int LCDSetFontSize(int twelve); int LCDSetMode(int zero);
int LCDMenu(char *st1, char *st2, char *st3, char *st4); int LCDMenuI(int pos, char *string, COLOR fg, COLOR bg);
int LCDGetSize(int *x, int *y); int LCDPixel(int x, int y, COLOR col); COLOR LCDGetPixel(int x, int y);
int LCDLine(int x1, int y1, int x2, int y2, COLOR col); int LCDArea(int x1, int y1, int x2, int y2, COLOR col, int fill);
int LCDCircle(int x1, int y1, int size, COLOR col, int fill); int LCDImageSize(int qvga);
int LCDImage(BYTE *img); int LCDImageGray(BYTE *g); int LCDImageBinary(BYTE *b);
int LCDImageStart(int x, int y, int xs, int ys); int LCDRefresh(void);
int KEYGet(void); int KEYRead(void); int KEYWait(int key); int KEYGetXY(int *x, int *y); int KEYReadXY(int *x, int *y);
int CAMInit(int qvga); int CAMGet(BYTE *img); int CAMGetGray(BYTE *g); int CAMRelease(void);
int IPSetSize(int qvga); int IPWriteFile(char *filename, BYTE *img); int IPWriteFileGray(char *grayname, BYTE *g);
int IPReadFile(char *filename, BYTE *img); void IPLaplace(BYTE *g, BYTE *gOut); void IPSobel(BYTE *g, BYTE *gOut);
void IPCol2Gray(BYTE *img, BYTE *gOut); void IPGray2Col(BYTE *g, BYTE *imgOut);
void IPRGB2Col(BYTE *g, BYTE *g, BYTE *g, BYTE *imgOut); void IPCol2HSI(BYTE *img, BYTE *gOut, BYTE *gOut, BYTE *gOut);
void IPOverlay(BYTE *img, BYTE *img, BYTE *imgOut); void IPOverlayGray(BYTE *g, BYTE *g, COLOR col, BYTE *imgOut);
COLOR IPPRGB2Col(BYTE r, BYTE g, BYTE b); void IPPCol2RGB(COLOR col, BYTE *r, BYTE *g, BYTE *b);
void IPPCol2HSI(COLOR c, BYTE *h, BYTE *s, BYTE *i); BYTE IPPRGB2Hue(BYTE r, BYTE g, BYTE b);
void IPPRGB2HSI(BYTE r, BYTE g, BYTE b, BYTE *h, BYTE *s, BYTE *i);
int OSExecute(char *command, char *out); int OSVersion(char *buf); int OSVersionIO(char *buf); int OSMachineSpeed(void);
int OSMachineType(void); int OSMachineName(char *buf); int OSMachineID(void); int OSWait(int n);
TIMER OSAttachTimer(int scale, fct); int OSDetachTimer(TIMER t); int OSSetTime(int hrs, int mins, int secs);
int OSGetTime(int *hrs, int *mins, int *secs, int *ticks); int OSGetCount(void);
int SERInit(int interface, int baud, int handshake); int SERSendChar(int interface, char ch);
int SERSend(int interface, char *text, uint32_t size); int SERReceiveChar(int closed); int SERReceive(int interface, unsigned char *buf);
bool SERCheck(int interface); int SERFlush(int interface); int SERClose(int interface);
int AUBeep(void); int AUPlay(char *text); int AUDone(void); int AUMicrophone(void);
int PSDGet(int psd); int PSDGetRaw(int psd); int LIDARGet(int *scan); void LIDARSet(int range, int tilt, int points);
int SERVOSet(int servo, int angle); int SERVOSetRaw(int servo, int angle); int SERVORange(int servo, int low, int high);
int MOTORDrive(int motor, int speed); int MOTORDriveRaw(int motor, int speed); int MOTORPID(int motor, int p, int i, int d);
int MOTORPIDOff(int motor); int MOTORSpeed(int motor, int ticks); int ENCODERRead(int quad); int ENCODERReset(int quad);
int VWSetSpeed(int linSpeed, int angSpeed); int VWGetSpeed(int *linSpeed, int *angSpeed);
int VWSetPosition(int x, int y, int phi); int VWGetPosition(int *x, int *y, int *phi); int VWStraight(int dist, int lin_speed);
int VWTurn(int angle, int ang_speed); int VWCurve(int dist, int angle, int lin_speed); int VWDrive(int dx, int dy, int lin_speed);
int VWRemain(void); int VWDone(void); int VWWait(void); int VWStalled(void);
int DIGITALSetup(int io, char direction); int DIGITALRead(int io); int DIGITALReadAll(void); int DIGITALWrite(int io, int state);
int ANALOGRead(int channel); int ANALOGVoltage(void); int ANALOGRecord(int channel, int iterations);
int ANALOGTransfer(BYTE *img); int IRTVGet(void); int IRTVRead(void); int IRTVFlush(void); int IRTVGetStatus(void);
int RADIOInit(void); int RADIOGetID(void); int RADIOSend(int id, char *text); int RADIOCheck(int *id_no);
int RADIOStatus(int *list); int RADIORelease(void); int RADIOReceive(int *id, char *buf, int size);
void SIMGetRobot(int id, int *x, int *y, int *z, int *phi); void SIMSetRobot(int id, int x, int y, int z, int phi);
void SIMGetObject(int object, int *x, int *y, int *z, int *phi); void SIMSetObject(int object, int x, int y, int z, int phi);
int SIMGetRobotCount(void); int SIMGetObjectCount(void);
int VWControl(int Vv, int Tv, int Vw, int Tw); int VWControlOff(void); int VWDriveRemain(void); int VWDriveDone(void);
int VWDriveWait(void); int VWDriveReady(void); int LCDPixelInvert(int x, int y); int LCDLineInvert(int x1, int y1, int x2, int y2);
int LCDAreaInvert(int x1, int y1, int x2, int y2); int LCDCircleInvert(int x1, int y1, int size); int LCDInit(void);
int SERSend(int interface, char *text); int RADIOSend(int id, char *text, int size); int AUTone(int freq, int time);
int AUCheckTone(void); int AUCheckPlay(void); int AURecord(BYTE *img, int time, long freq); int AUCheckRecord(void);
void SIMGetPose(int *x, int *y, int *phi); void SIMSetPose(int x, int y, int phi); int SIMLaserScan(int *scan);
void SIMGetObject(int object, int *x, int *y, int *phi); void SIMSetObject(int object, int x, int y, int phi);
int MOTORPIDoff(int motor); int OSShowTime(void); int SERVOGet(int servo); int SERVODone(int servo); int SERVOWait(int servo);
";

/// Functions of the headers that are in no `eye.py`, called in C only.
const ONLY_C: &str = "
int MTInit(void); int MTSleep(int n); int SEMAInit(sema, int val); int SEMALock(sema); int SEMAUnlock(sema); int XInitThreads(void);
";

/// Functions of the C library that EyeSim's `types.h` brings.
const BROUGHT: &str = "usleep(10); sum += (int)sqrt(M_PI) + (int)time(NULL) * 0 + errno * 0 + SIGINT * 0 + True + False; \
    { struct timeval t; gettimeofday(&t, NULL); sum += (int)t.tv_sec * 0; } { sem_t s; sem_init(&s, 0, 1); sem_wait(&s); }";

/// Constants, and sizes that stand before `_X` and the like.
const CONSTANTS: &str = "QQVGA QVGA VGA CAM1MP CAMHD CAM5MP CUSTOM RED GREEN BLUE WHITE GRAY BLACK SILVER LIGHTGRAY DARKGRAY NAVY \
    CYAN TEAL MAGENTA PURPLE MAROON YELLOW OLIVE ORANGE NOKEY KEY1 KEY2 KEY3 KEY4 ANYKEY KEY_INVALID KEY_LIST1 KEY_LIST2 KEY_LIST3 \
    KEY_LIST4 KEY_LIST5 KEY_LIST6 KEY_LIST7 KEY_LIST8 KEY_LISTDN KEY_LISTUP KEY_LISTTL KEY_ESCAPE KEYTM_UNKNOWN KEYTM_CLASSIC \
    KEYTM_STANDARD KEYTM_REGIONS KEYTM_LISTMENU HELVETICA TIMES COURIER NORMAL BOLD ITALICS VEHICLE PLATFORM WALKER MACHINE_SPEED \
    MACHINE_TYPE MACHINE_ID IRTV_0 IRTV_9 IRTV_RED IRTV_GREEN IRTV_YELLOW IRTV_BLUE IRTV_LEFT IRTV_RIGHT IRTV_UP IRTV_DOWN IRTV_OK \
    IRTV_POWER LCD_BGCOL_TRANSPARENT LCD_BGCOL_NOTRANSPARENT LCD_BGCOL_INVERSE LCD_BGCOL_NOINVERSE LCD_FGCOL_INVERSE \
    LCD_FGCOL_NOINVERSE LCD_AUTOREFRESH LCD_NOAUTOREFRESH LCD_SCROLLING LCD_NOSCROLLING LCD_LINEFEED LCD_NOLINEFEED LCD_SHOWMENU \
    LCD_HIDEMENU LCD_LISTMENU LCD_CLASSICMENU LCD_FB_ROTATE LCD_FB_NOROTATION PSD_FRONT PSD_LEFT PSD_RIGHT PSD_BACK CAM_SUCCESS \
    CAM_FAILURE CAMWIDTH CAMHEIGHT CAMPIXELS CAMSIZE CAMMODE IP_WIDTH IP_HEIGHT IP_PIXELS IP_SIZE LIDAR_RESOLUTION";
const SIZES: [&str; 6] = ["QQVGA", "QVGA", "VGA", "CAM1MP", "CAMHD", "CAM5MP"];
const OF_SIZES: [&str; 4] = ["_X", "_Y", "_PIXELS", "_SIZE"];

/// A function: its name, and the kinds and names of its parameters.
struct Function {
    name: &'static str,
    parameters: Vec<(&'static str, &'static str)>,
}

fn functions(text: &'static str) -> Vec<Function> {
    let declaration = |text: &'static str| {
        let (head, parameters) = text.trim().split_once('(')?;
        let name = head.rsplit(' ').next()?;
        let parameters = parameters.trim_end_matches(')').split(", ").filter(|text| *text != "void");
        let parameter = |text: &'static str| {
            let name = text.rsplit([' ', '*']).next().unwrap_or(text);
            let kind = text[..text.len() - name.len()].trim();
            if kind.is_empty() { (text, text) } else { (kind, name) }
        };
        Some(Function { name, parameters: parameters.map(parameter).collect() })
    };
    text.split(';').filter_map(declaration).collect()
}

/// A whole number that the parameter of this name takes.
fn number(name: &str) -> i32 {
    match name {
        "twelve" => 12,
        "qvga" | "id" | "interface" | "pos" | "scale" | "handshake" => 1,
        "servo" | "motor" | "quad" | "io" | "channel" | "state" => 1,
        "key" => -1,
        "object" | "psd" | "size" => 2,
        "closed" | "zero" | "fill" => 0,
        "xs" => 320,
        "ys" => 240,
        "baud" => 9600,
        "points" | "range" => 360,
        "freq" => 1000,
        "tilt" | "z" => 0,
        _ => 10,
    }
}

/// Argument passed by a C program.
fn argument_in_c(kind: &str, name: &str) -> String {
    match kind {
        "int" | "long" | "uint32_t" => number(name).to_string(),
        _ if name == "scan" || name == "list" => "numbers".to_owned(),
        "int *" => "&number".to_owned(),
        "COLOR" => "RED".to_owned(),
        "TIMER" => "timer".to_owned(),
        "BYTE *" if ["img", "imgOut", "b"].contains(&name) || name.starts_with('g') => {
            if name.starts_with('g') || name == "b" { "grey" } else { "colour" }.to_owned()
        }
        "BYTE *" => "&byte".to_owned(),
        "BYTE" => "200".to_owned(),
        "char" => "'i'".to_owned(),
        "unsigned char *" => "text".to_owned(),
        "fct" => "tick".to_owned(),
        "sema" => "&sema".to_owned(),
        _ => match name {
            "buf" | "out" => "(char *)text".to_owned(),
            "filename" => "(char *)\"a.ppm\"".to_owned(),
            "grayname" => "(char *)\"a.pgm\"".to_owned(),
            _ => "(char *)\"text\"".to_owned(),
        },
    }
}

fn program_in_c() -> String {
    let mut text = String::from(
        "static BYTE colour[3 * 320 * 240], grey[3 * 320 * 240], byte;\nstatic int number, numbers[65536];\n\
         static unsigned char text[4096];\nstatic SEMA sema;\nstatic TIMER timer;\nstatic void tick(void) { number++; }\n\
         static void *task(void *data) { return data; }\nint main(void)\n{\n    long sum = 0;\n    TASK spawned;\n",
    );
    let mut add = |line: String| writeln!(text, "    {line}").expect("a string takes all");
    for name in CONSTANTS.split_whitespace() {
        add(format!("sum += {name};"));
    }
    for size in SIZES {
        OF_SIZES.iter().for_each(|of| add(format!("sum += {size}{of};")));
        add(format!("sum += sizeof({size}col) - sizeof({size}gray);"));
    }
    add(format!("sum += sizeof(MACHINE_NAME) + sizeof(VERSION) + sizeof(DeviceSemantics); {BROUGHT}"));
    add("spawned = MTSpawn(task, 3); sum += MTGetUID(spawned); MTKill(spawned); RADIOCheck();".to_owned());
    for Function { name, parameters } in functions(ONLY_C).iter().chain(&functions(FUNCTIONS)) {
        let arguments: Vec<String> = parameters.iter().map(|(kind, name)| argument_in_c(kind, name)).collect();
        let is_timer = *name == "OSAttachTimer";
        let call = format!("{name}({});", arguments.join(", "));
        add(if is_timer { format!("timer = {call}") } else { call });
    }
    add("{ char *said = OSExecute((char *)\"true\"); sum += said != NULL; }".to_owned());
    text + "    printf(\"all called %d\\n\", sum != 0);\n    return 0;\n}\n"
}

/// Argument passed by a Python program, as accepted by the original.
fn argument_in_python(kind: &str, name: &str, is_numpy: bool) -> String {
    let image = |size: &str| match is_numpy {
        true => format!("np.zeros({size}, np.uint8).ctypes.data_as(POINTER(c_byte))"),
        false => format!("(c_byte * {size})()"),
    };
    match argument_in_c(kind, name).as_str() {
        "numbers" if is_numpy => "np.zeros(65536, np.int32).ctypes.data_as(POINTER(c_int))".to_owned(),
        "numbers" => "(c_int * 65536)()".to_owned(),
        "&number" if is_numpy => "byref(c_int())".to_owned(),
        "&number" => "c_int()".to_owned(),
        "&byte" => "c_byte()".to_owned(),
        "grey" => image("QVGA_PIXELS"),
        "colour" => image("QVGA_SIZE"),
        "tick" => "tick".to_owned(),
        "'i'" => if is_numpy { "b'i'" } else { "'i'" }.to_owned(),
        "(char *)text" | "text" => "ctypes.create_string_buffer(4096)".to_owned(),
        text if text.starts_with("(char *)") => text["(char *)".len()..].to_owned(),
        number if is_numpy && number.parse::<i32>().is_ok() => format!("c_int({number})"),
        other => other.to_owned(),
    }
}

fn is_out(kind: &str, name: &str) -> bool {
    let is_text = name == "buf" || name == "out";
    kind == "int *" || name.ends_with("Out") || is_text || argument_in_c(kind, name) == "&byte"
}

/// Calls each function with values of ctypes, through `lib`, and without what it returns.
fn program_in_python(is_numpy: bool) -> String {
    let mut text = String::from("from eye import *\nimport eye\nsum = 0\ndef tick():\n    pass\ntimer = 0\n");
    let mut add = |line: String| writeln!(text, "{line}").expect("a string takes all");
    for name in CONSTANTS.split_whitespace() {
        add(format!("sum += {name}"));
    }
    for size in SIZES {
        OF_SIZES.iter().for_each(|of| add(format!("sum += {size}{of}")));
        add(format!("sum += CAMSIZEARR[{size}] + CAMPIXELSARR[{size}] + CAMWIDTHARR[{size}] + CAMHEIGHTARR[{size}]"));
    }
    for Function { name, parameters } in functions(FUNCTIONS) {
        let all: Vec<String> = parameters.iter().map(|(kind, name)| argument_in_python(kind, name, is_numpy)).collect();
        let kept = if name == "OSAttachTimer" { "timer = " } else { "" };
        add(format!("{kept}{name}({})", all.join(", ")));
        if !["KEYGet", "KEYWait", "KEYGetXY", "IRTVGet", "OSAttachTimer", "RADIOInit", "RADIORelease"].contains(&name) {
            add(format!("lib.{name}({})", all.join(", ")));
        }
        let inputs: Vec<&String> =
            all.iter().zip(&parameters).filter(|(_, (kind, name))| !is_out(kind, name)).map(|(text, _)| text).collect();
        let is_buffer =
            ["CAMGet", "CAMGetGray", "LIDARGet", "IPReadFile", "RADIOStatus", "ANALOGTransfer", "SIMLaserScan"];
        if inputs.len() < all.len() && name != "KEYGetXY" && name != "RADIOReceive" {
            let inputs: Vec<&str> = inputs.into_iter().map(String::as_str).collect();
            add(format!("{name}({})", inputs.join(", ")));
        } else if is_buffer.contains(&name) {
            add(format!("{name}({})", if name == "IPReadFile" { "\"a.ppm\"" } else { "" }));
        }
    }
    text + "print('all called', sum != 0)\n"
}

fn run(files: &[(&str, &str)], robot: &str, args: &[&str]) -> (Scratch, Ran) {
    let scratch = Scratch::new();
    files.iter().for_each(|(name, text)| drop(scratch.write(name, text)));
    scratch.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    scratch.write("a.sim", &format!("world room.wld\nS4 1000 1000 0 {robot}\ncan 3000 3000 0\n"));
    let presses: Vec<String> =
        (1..40).map(|second| format!("{second}:KEY1, {second}.2:TOUCH(100,100), {second}.4:IRTV_OK")).collect();
    let keys = presses.join(", ");
    let ran = scratch.eyesim(&[&["run", "a.sim", "--keys", keys.as_str(), "--until", "120"], args].concat());
    (scratch, ran)
}

fn has(command: &str, code: &str) -> bool {
    let has = std::process::Command::new(command).args(["-c", code]).output().is_ok_and(|out| out.status.success());
    if !has {
        println!("skipped: `{command}` cannot run `{code}`");
    }
    has
}

#[test]
fn every_name_of_the_headers_is_called_in_c() {
    let program = format!("#include \"eyebot.h\"\n{}", program_in_c());
    let (_, ran) = run(&[("all.c", &program)], "all.c", &["--api", "7"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains("all called 1") && !ran.stderr.contains("warning"), "{ran:#?}");
}

#[test]
fn every_name_of_the_headers_is_called_in_cpp() {
    let program = format!("#include \"eyebot++.h\"\n{}", program_in_c());
    let (_, ran) = run(&[("all.cpp", &program)], "all.cpp", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains("all called 1"), "{ran:#?}");
}

#[test]
fn every_name_is_called_in_python() {
    if !has("python3", "pass") {
        return;
    }
    let (_, ran) = run(&[("all.py", &program_in_python(false))], "all.py", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains("all called True"), "{ran:#?}");
}

#[test]
fn every_name_is_called_in_python_with_arrays_of_numpy() {
    if !has("python3", "import numpy") {
        return;
    }
    let (_, ran) = run(&[("all.py", &program_in_python(true))], "all.py", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains("all called True"), "{ran:#?}");
}

#[test]
fn every_function_of_the_list_is_among_those_that_are_called() {
    let ours = ["LEG", "CAMGetDepth", "CAMGetLabels", "PSDGetSignal", "LCDListLine", "OSError"];
    let called: BTreeSet<&str> = functions(FUNCTIONS).iter().map(|function| function.name).collect();
    let missing: Vec<&str> = robios_sys::Robios7Call::ALL
        .iter()
        .map(|call| call.name())
        .filter(|name| !called.contains(name) && !ours.iter().any(|our| name.starts_with(our)))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn results_serve_as_numbers_as_values_of_ctypes_and_as_arrays() {
    if !has("python3", "pass") {
        return;
    }
    let program = r#"
from eye import lib
from eye import *
x, y, z, phi = SIMGetRobot(1)
assert (x.value, x) == (1000, 1000) and VWGetPosition() == (0, 0, 0) == tuple(VWGetPosition())
assert "%d %d %d" % VWGetPosition() == "0 0 0" and VWGetPosition() == [0, 0, 0]
own = VWGetPosition(); own[2] += 90; assert own == (0, 0, 90) and "%d %d %d" % own == "0 0 90"
x, y, phi = SIMGetObject(2); assert (x, y, phi) == (3000, 3000, 0)
x, y, z, phi = SIMGetObject(2); assert (x, y, z, phi.value) == (3000, 3000, 0, 0)
a, b, c = c_int(7), c_int(7), ctypes.c_int(7)
assert VWGetPosition(a, byref(b), pointer(c)) == 0 and (a.value, b.value, c.value) == (0, 0, 0)
buf = ctypes.create_string_buffer(32); assert OSVersion(buf) == 0 and buf.value == b"1.0" and OSVersion("") == "1.0"
CAMInit(QQVGA); img = CAMGet(); LCDImageStart(0, 0, QQVGA_X, QQVGA_Y)
p = ctypes.cast(img, POINTER(c_byte)); assert p[0] & 255 == img[0] == bytes(img)[0] and img[0:3] == list(img)[0:3]
for use in (img, p, byref(img), pointer(img), bytes(img), bytearray(img), list(img), memoryview(img)):
    LCDClear(); LCDImage(use); assert LCDGetPixel(3, 3) == IPPRGB2Col(*img[3 * 483 : 3 * 483 + 3]), use
for bad in (b"short", (c_byte * 100)(), 5):
    try:
        LCDImage(bad); assert False
    except (ValueError, TypeError) as error:
        assert "LCDImage" in str(error)
assert IPWriteFile("b.ppm", img) == 0 and len(IPReadFile("b.ppm")) == QVGA_SIZE // 4
result, again = IPReadFile("b.ppm"); assert result == 6 and again == img
LCDPrintf("text\n", ""); LCDPrintf("100%\n"); LCDPrintf("%d%%\n", c_int(5)); assert LCDGetPos() == (3, 0)
RADIOInit(); number, ids = RADIOStatus(); assert number == 1 and ids[0] == 1 and len(RADIOStatus()) == 1
SIMSetRobot(1500, 1200, 0, 90); assert SIMGetRobot(0) == (1500, 1200, 0, 90)
assert ctypes.CDLL("libeyesim.so") is lib and lib.PSDGet(c_int(1)) == PSDGet(PSD_FRONT) and KEYWait != ANYKEY
assert ctypes.cast(LIDARGet(), POINTER(c_int))[180] == LIDARGet()[180] == min(LIDARGet()[170:190])
print("all well")
"#;
    let (_, ran) = run(&[("a.py", program)], "a.py", &[]);
    assert!(ran.stdout.contains("all well"), "{ran:#?}");
}

#[test]
fn what_threads_print_is_not_lost() {
    if !has("python3", "pass") {
        return;
    }
    let program = "import threading, time\nfrom eye import *\n\
        def work(name):\n    for i in range(3):\n        print(name, i)\n        time.sleep(0.5)\n    OSWait(100)\n    print(name, end=' rest')\n\
        threads = [threading.Thread(target=work, args=(name,)) for name in 'ab']\n\
        [thread.start() for thread in threads]\nVWStraight(100, 100)\nVWWait()\nprint('main')\n";
    let (_, ran) = run(&[("a.py", program)], "a.py", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    for said in ["a 0", "a 2", "b 2", "main", "a rest", "b rest"] {
        assert!(ran.stdout.contains(&format!("] {said}\n")), "{said}: {ran:#?}");
    }
}

#[test]
fn a_module_that_computes_long_while_it_is_imported_is_no_endless_loop() {
    if !has("python3", "pass") {
        return;
    }
    let heavy = "import os\ndef burn(seconds):\n    end = sum(os.times()[:2]) + seconds\n    \
                 while sum(os.times()[:2]) < end:\n        pass\nburn(2.5)\n";
    let program = "from eye import *\nprint('begins')\nimport heavy\nprint('imported')\nheavy.burn(30)\n";
    let (scratch, ran) =
        run(&[("a.py", program), ("heavy.py", heavy)], "a.py", &["--timeout", "1", "--report", "r.json"]);
    assert!(ran.stdout.contains("imported"), "{ran:#?}");
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    assert_eq!(report["robots"][0]["outcome"], "timeout", "what it does afterwards is: {report:#}");
}

#[test]
fn headers_of_another_year_beside_a_program_give_way() {
    let header = "#ifndef EYEBOT_H_\n#define EYEBOT_H_\n#include \"types.h\"\nint VWStraight(float m);\nint LCDClear(void);\n#endif\n";
    let types = "#include <X11/NoSuch.h>\n#define QVGA_X 1\n#define QVGA_Y 1\n#define QVGA_SIZE 3\n#define KEY_LIST1 1\n#define KEY_LIST2 2\n\
                 #define KEY_LIST3 3\n#define IRTV_OK 1\n#define IRTV_UP 2\n#define LCD_SCROLLING 3\n";
    let program = "#include \"eyebot.h\"\n#include \"own.h\"\nint main(void) { VWStraight(100, 100); VWWait(); printf(\"%s %d\\n\", __FILE__, OWN); return 0; }\n";
    let files = [("a.c", program), ("eyebot.h", header), ("types.h", types), ("own.h", "#define OWN 42\n")];
    let (_, ran) = run(&files, "a.c", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains("] a.c 42"), "{ran:#?}");
    let said = "`eyebot.h`, `types.h` beside the program is RoBIOS's own: eyesim's is used instead";
    assert!(ran.stderr.contains(said), "{ran:#?}");
    // A wrapper of our library, and types of the program's own, are kept.
    let wrapper = "#include_next <eyebot.h>\nstatic inline int go(void) { return VWStraight(100, 100); }\n";
    let program =
        "#include \"eyebot.h\"\n#include \"types.h\"\nint main(void) { Cell c = go(); VWWait(); return c; }\n";
    let files = [("a.c", program), ("eyebot.h", wrapper), ("types.h", "typedef int Cell;\n")];
    let (_, ran) = run(&files, "a.c", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(!ran.stderr.contains("RoBIOS's own"), "{ran:#?}");
}

#[test]
fn functions_without_a_declaration_get_what_their_author_means() {
    let program = "void f(float s) { sleep(s); }\nint main(void) { f(18.0f); VWStraight(100.7, 100.2); VWWait(); OSWait(0.5 + sqrt(4.0)); return 0; }\n";
    let (_, ran) = run(&[("a.c", program)], "a.c", &["--report", "r.json"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("the headers that declare `sleep`"), "{ran:#?}");
    assert!(ran.stdout.contains("19.") || ran.stdout.contains("20."), "18 s and a drive: {ran:#?}");
}

#[test]
fn names_that_collide_with_what_the_headers_bring_stay_the_programs_own() {
    let program = "#include \"eyebot.h\"\nint y1 = 3;\nvoid pause(int ms) { OSWait(ms); }\nint main(void) { pause(y1); VWWait(); return 0; }\n";
    let (_, ran) = run(&[("a.c", program)], "a.c", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
}

#[test]
fn cpp_is_compiled_in_the_newest_standard_or_in_that_of_its_time() {
    let new = "#include \"eyebot++.h\"\n#include <concepts>\ntemplate <std::integral T> T twice(T x) { return 2 * x; }\n\
               int main() { VWStraight(twice(50), 100); VWWait(); }\n";
    let (_, ran) = run(&[("a.cpp", new)], "a.cpp", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let old = "#include \"eyebot++.h\"\nint main() { int concept = 1, requires = 2; VWStraight(concept + requires, 100); VWWait(); }\n";
    let (_, ran) = run(&[("a.cpp", old)], "a.cpp", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
}

#[test]
fn what_compiles_for_one_generation_only_is_of_that_one() {
    // `LCDSetPos` is in both, but this call has the arguments of neither `OSVersion` of RoBIOS 6.
    let program = "#include \"eyebot.h\"\nint main(void) { char text[32]; BYTE grey[9]; COLOR red = 3; OSVersion(text); return red == 4 && grey[0]; }\n";
    let (scratch, _) = run(&[("a.c", program)], "a.c", &[]);
    scratch.write("classic.sim", "world room.wld\nrobi %sim%/robis/scout.robi a.c 1000 1000 0\n");
    scratch.write("a.c", &format!("{program}\n/* new */\n"));
    let ran = scratch.eyesim(&["run", "classic.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("a.c: RoBIOS-7, as it does not compile for RoBIOS 6"), "{ran:#?}");
}
