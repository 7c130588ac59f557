//! Every name of the headers of both generations and of `eye.py`, in programs generated from the signatures. They call
//! each function once in each form that EyeSim VR allows, and use each constant and type. The test reports names that
//! fail.

use std::collections::BTreeSet;

use robios_sys::robios6::{hdt_type, semantics};
use robios_sys::table::Function;
use robios_sys::{Robios6Call, Robios7Call, robios6, robios7};
use tests::{Ran, Scratch};

/// Functions of the RoBIOS-7 headers of all years, ordered so that each finds its prerequisites. Parameter names select
/// the arguments.
const FUNCTIONS_7: &str = "
int LCDPrintf(const char *format); int LCDSetPrintf(int row, int column, const char *format); int LCDClear(void);
int LCDSetPos(int row, int column); int LCDGetPos(int *row, int *column); int LCDSetColor(COLOR fg, COLOR bg);
int LCDSetFont(int font, int one); int LCDSetFontSize(int twelve); int LCDSetMode(int zero);
int LCDMenu(char *st1, char *st2, char *st3, char *st4); int LCDMenuI(int pos, char *string, COLOR fg, COLOR bg);
int LCDGetSize(int *x, int *y); int LCDPixel(int x, int y, COLOR col); COLOR LCDGetPixel(int x, int y);
int LCDLine(int x1, int y1, int x2, int y2, COLOR col); int LCDArea(int x1, int y1, int x2, int y2, COLOR col, int fill);
int LCDCircle(int x1, int y1, int size, COLOR col, int fill); int LCDImageSize(int qvga);
int LCDImage(BYTE *img); int LCDImageGray(BYTE *g); int LCDImageBinary(BYTE *g);
int LCDImageStart(int x, int y, int xs, int ys); int LCDRefresh(void);
int KEYGet(void); int KEYRead(void); int KEYWait(int key); int KEYGetXY(int *x, int *y); int KEYReadXY(int *x, int *y);
int CAMInit(int qvga); int CAMGet(BYTE *imgOut); int CAMGetGray(BYTE *gOut); int CAMRelease(void);
int IPSetSize(int qvga); int IPWriteFile(char *filename, BYTE *img); int IPWriteFileGray(char *grayname, BYTE *g);
int IPReadFile(char *filename, BYTE *imgOut); void IPLaplace(BYTE *g, BYTE *gOut); void IPSobel(BYTE *g, BYTE *gOut);
void IPCol2Gray(BYTE *img, BYTE *gOut); void IPGray2Col(BYTE *g, BYTE *imgOut);
void IPRGB2Col(BYTE *g, BYTE *g, BYTE *g, BYTE *imgOut); void IPCol2HSI(BYTE *img, BYTE *gOut, BYTE *gOut, BYTE *gOut);
void IPOverlay(BYTE *img, BYTE *img, BYTE *imgOut); void IPOverlayGray(BYTE *g, BYTE *g, COLOR col, BYTE *imgOut);
COLOR IPPRGB2Col(BYTE r, BYTE g, BYTE b); void IPPCol2RGB(COLOR col, BYTE *r, BYTE *g2, BYTE *b);
void IPPCol2HSI(COLOR c, BYTE *h, BYTE *s, BYTE *i); BYTE IPPRGB2Hue(BYTE r, BYTE g, BYTE b);
void IPPRGB2HSI(BYTE r, BYTE g, BYTE b, BYTE *h, BYTE *s, BYTE *i);
int OSExecute(char *command, char *out); int OSVersion(char *buf); int OSVersionIO(char *buf); int OSMachineSpeed(void);
int OSMachineType(void); int OSMachineName(char *buf); int OSMachineID(void); int OSWait(int n);
TIMER OSAttachTimer(int scale, fct); int OSDetachTimer(TIMER t); int OSSetTime(int hrs, int mins, int secs);
int OSGetTime(int *hrs, int *mins, int *secs, int *ticks); int OSGetCount(void); int OSShowTime(void);
int SERInit(int interface, int baud, int handshake); int SERSendChar(int interface, char ch);
int SERSend(int interface, char *text, uint32_t size); int SERSend(int interface, char *text);
int SERReceiveChar(int closed); int SERReceive(int interface, unsigned char *buf); bool SERCheck(int interface);
int SERFlush(int interface); int SERClose(int interface);
int AUBeep(void); int AUPlay(char *text); int AUDone(void); int AUMicrophone(void); int AUTone(int freq, int time);
int AUCheckTone(void); int AUCheckPlay(void); int AURecord(BYTE *imgOut, int time, long freq); int AUCheckRecord(void);
int PSDGet(int psd); int PSDGetRaw(int psd); int LIDARGet(int *scan); void LIDARSet(int range, int tilt, int points);
int SIMLaserScan(int *scan); int SERVOSet(int servo, int angle); int SERVOSetRaw(int servo, int angle);
int SERVORange(int servo, int low, int high); int SERVOGet(int servo); int SERVODone(int servo); int SERVOWait(int servo);
int MOTORDrive(int motor, int speed); int MOTORDriveRaw(int motor, int speed); int MOTORPID(int motor, int p, int i, int d);
int MOTORPIDOff(int motor); int MOTORPIDoff(int motor); int MOTORSpeed(int motor, int ticks); int ENCODERRead(int quad);
int ENCODERReset(int quad); int VWSetSpeed(int linSpeed, int angSpeed); int VWGetSpeed(int *linSpeed, int *angSpeed);
int VWSetPosition(int x, int y, int phi); int VWGetPosition(int *x, int *y, int *phi); int VWStraight(int dist, int lin_speed);
int VWTurn(int angle, int ang_speed); int VWCurve(int dist, int angle, int lin_speed); int VWDrive(int dx, int dy, int lin_speed);
int VWRemain(void); int VWDone(void); int VWWait(void); int VWStalled(void); int VWControl(int Vv, int Tv, int Vw, int Tw);
int VWControlOff(void); int VWDriveRemain(void); int VWDriveDone(void); int VWDriveWait(void); int VWDriveReady(void);
int DIGITALSetup(int io, char direction); int DIGITALRead(int io); int DIGITALReadAll(void); int DIGITALWrite(int io, int state);
int ANALOGRead(int channel); int ANALOGVoltage(void); int ANALOGRecord(int channel, int iterations);
int ANALOGTransfer(BYTE *imgOut); int IRTVGet(void); int IRTVRead(void); int IRTVFlush(void); int IRTVGetStatus(void);
int RADIOInit(void); int RADIOGetID(void); int RADIOSend(int zero, char *text); int RADIOSend(int zero, char *text, int size);
int RADIOCheck(void); int RADIOCheck(int *id_no); int RADIOStatus(int *list); int RADIOReceive(int *id, char *buf, int capacity);
int RADIORelease(void);
void SIMGetRobot(int id, int *x, int *y, int *z, int *phi); void SIMSetRobot(int id, int x, int y, int z, int phi);
void SIMGetObject(int object, int *x, int *y, int *z, int *phi); void SIMSetObject(int object, int x, int y, int z, int phi);
void SIMGetObject(int object, int *x, int *y, int *phi); void SIMSetObject(int object, int x, int y, int phi);
int SIMGetRobotCount(void); int SIMGetObjectCount(void); void SIMGetPose(int *x, int *y, int *phi);
void SIMSetPose(int x, int y, int phi); int LCDPixelInvert(int x, int y); int LCDLineInvert(int x1, int y1, int x2, int y2);
int LCDAreaInvert(int x1, int y1, int x2, int y2); int LCDCircleInvert(int x1, int y1, int size); int LCDInit(void);
";

/// Functions of RoBIOS-7 that no `eye.py` contains.
const ONLY_C_7: &str = "
int MTInit(void); int MTSleep(int n); int SEMAInit(sema, int n); int SEMALock(sema); int SEMAUnlock(sema); int XInitThreads(void);
int LCDList(menu); int LCDSetList(menu); listmenu_t *LCDGetList(void); menuitem_t *LCDListActiveItem(void);
char *OSExecute(char *command); int MTGetUID(TASK task); int MTKill(TASK task);
";

/// Functions of RoBIOS 6, ordered so that each finds its prerequisites.
const FUNCTIONS_6: &str = "
char *OSVersion(void); int OSError(char *msg, int number, BOOL zero); int OSMachineType(void); int OSMachineSpeed(void);
char *OSMachineName(void); unsigned char OSMachineID(void); int OSDisable(void); int OSEnable(void); int OSPutVar(int num, int value);
int OSGetVar(int num); int HDT_Validate(void); void *HDT_FindEntry(TypeID HDT_MOTOR, DeviceSemantics MOTOR_LEFT);
int HDT_FindTable(TypeID HDT_MOTOR, int zero, HDT_entry_type *entry); int HDT_TypeCount(TypeID HDT_PSD);
int LCDPrintf(const char *format); int LCDSetPrintf(int row, int column, const char *format); int LCDClear(void);
int LCDPutChar(char c); int LCDSetChar(int row, int column, char c); int LCDPutString(char *text);
int LCDSetString(int row, int column, char *text); int LCDPutHex(int v); int LCDPutHex1(int v); int LCDPutInt(int v);
int LCDPutIntS(int v, int spaces); int LCDPutFloat(float v); int LCDPutFloatS(float v, int spaces, int decimals);
int LCDMode(int zero); int LCDSetPos(int row, int column); int LCDGetPos(int *row, int *column); int LCDPutGraphic(image *grey);
int LCDPutColorGraphic(colimage *colour); int LCDPutImage(BYTE *bits); int LCDMenu(char *s1, char *s2, char *s3, char *s4);
int LCDMenuI(int pos, char *text); int LCDSetPixel(int row, int column, int one); int LCDInvertPixel(int row, int column);
int LCDGetPixel(int row, int column); int LCDLine(int x1, int y1, int x2, int y2, int one);
int LCDArea(int x1, int y1, int x2, int y2, int one);
int KEYGetBuf(char *buf); int KEYGet(void); int KEYRead(void); int KEYWait(int key);
int CAMInit(int zero); int CAMMode(int one); int CAMSet(int level, int level, int level); int CAMGet(int *p1, int *p2, int *p3);
int CAMGetFrame(image *grey); int CAMGetColFrame(colimage *colour, int zero); int CAMGetFrameMono(BYTE *buf);
int CAMGetFrameColor(BYTE *buf); int CAMGetFrameRGB(BYTE *buf); int CAMGetFrameBayer(BYTE *buf); int CAMRelease(void);
int IPLaplace(image *grey, image *dest); int IPSobel(image *grey, image *dest); int IPDither(image *grey, image *dest);
int IPDiffer(image *grey, image *grey, image *dest); int IPColor2Grey(colimage *colour, image *dest);
int OSSetTime(int hrs, int mins, int secs); int OSGetTime(int *hrs, int *mins, int *secs, int *ticks); int OSShowTime(void);
int OSGetCount(void); int OSWait(int n); int OSSleep(int n); TimerHandle OSAttachTimer(int n, TimerFnc tick);
int OSDetachTimer(TimerHandle timer);
int OSInitRS232(int baud, int handshake, int interface); int OSSendCharRS232(char c, int interface);
int OSSendRS232(char *text, int interface); int OSRecvRS232(char *buf, int interface); int OSCheckInRS232(int interface);
int OSCheckOutRS232(int interface); int OSFlushInRS232(int interface); int OSFlushOutRS232(int interface);
int OSDownload(char *buf, int *bytes, int baud, int handshake, int interface); int USRStart(void); int USRResident(char *buf, BOOL one);
int AUPlaySample(char *buf); int AUCheckSample(void); int AUTone(int freq, int time); int AUCheckTone(void); int AUBeep(void);
int AURecordSample(BYTE *buf, long size, long freq); int AUCheckRecord(void); int AUCaptureMic(void);
PSDHandle PSDInit(DeviceSemantics PSD_FRONT); int PSDStart(PSDHandle psd, BOOL one); BOOL PSDCheck(void); int PSDGet(PSDHandle psd);
int PSDGetRaw(PSDHandle psd); int PSDStop(void); int PSDRelease(void);
ServoHandle SERVOInit(DeviceSemantics SERVO1); int SERVOSet(ServoHandle servo, int level); int SERVORelease(ServoHandle servo);
MotorHandle MOTORInit(DeviceSemantics MOTOR_LEFT); int MOTORDrive(MotorHandle motor, int speed); QuadHandle QUADInit(DeviceSemantics QUAD_LEFT);
int QUADReset(QuadHandle quad); int QUADRead(QuadHandle quad); DeviceSemantics QUADGetMotor(DeviceSemantics QUAD_LEFT);
float QUADODORead(QuadHandle quad); int QUADODOReset(QuadHandle quad); int QUADRelease(QuadHandle quad);
int MOTORRelease(MotorHandle motor);
VWHandle VWInit(DeviceSemantics VW_DRIVE, int one); int VWStartControl(VWHandle vw, float Vv, float Tv, float Vw, float Tw);
int VWSetSpeed(VWHandle vw, meterPerSec v, radPerSec w); int VWGetSpeed(VWHandle vw, SpeedType *speed);
int VWSetPosition(VWHandle vw, meter x, meter y, radians phi); int VWGetPosition(VWHandle vw, PositionType *pos);
int VWDriveStraight(VWHandle vw, meter delta, meterPerSec v); int VWDriveTurn(VWHandle vw, radians delta, radPerSec w);
int VWDriveCurve(VWHandle vw, meter delta_l, radians delta_phi, meterPerSec v); float VWDriveRemain(VWHandle vw);
int VWDriveDone(VWHandle vw); int VWDriveReady(VWHandle vw); int VWDriveWait(VWHandle vw); int VWStalled(VWHandle vw);
int VWStopControl(VWHandle vw); int VWRelease(VWHandle vw);
BumpHandle BUMPInit(DeviceSemantics BUMP_FRONT); int BUMPCheck(BumpHandle bump, int *timestamp); int BUMPRelease(BumpHandle bump);
IRHandle IRInit(DeviceSemantics IR_FRONT); int IRRead(IRHandle ir); int IRRelease(IRHandle ir);
BYTE OSReadInLatch(int one); BYTE OSWriteOutLatch(int one, BYTE mask, BYTE value); BYTE OSReadOutLatch(int one);
BYTE OSReadParData(void); void OSWriteParData(BYTE value); BYTE OSReadParSR(void); void OSWriteParCTRL(BYTE value);
BYTE OSReadParCTRL(void); int OSGetAD(int channel); int OSOffAD(int zero);
int COMPASSInit(DeviceSemantics COMPASS); int COMPASSStart(BOOL one); int COMPASSCheck(void); int COMPASSGet(void);
int COMPASSStop(void); int COMPASSCalibrate(int zero); int COMPASSRelease(void);
int IRTVInitHDT(DeviceSemantics IRTV); void IRTVTerm(void); int IRTVPressed(void); int IRTVRead(void); void IRTVFlush(void);
int IRTVInit(int one, int one, int one, int one, int one, int one, int one); int IRTVGet(unread);
void IRTVGetStatus(int *type, int *length, int *tog, int *inv, int *mode, int *bufsize, int *delay);
int RADIOGetIoctl(RadioIOParameters *radio); int RADIOSetIoctl(RadioIOParameters *radio); int RADIOInit(void);
int RADIOSend(BYTE zero, int size, BYTE *bits); int RADIOSend(BYTE zero, int size, BYTE *bits); int RADIOCheck(void);
int RADIORecv(BYTE *sender, int *bytes, BYTE *buf); int RADIOGetStatus(RadioStatus *status); int RADIOTerm(void);
int OSMTInit(BYTE zero); int OSMTStatus(void); int OSSemInit(struct sem *sem, int one); int OSSemP(struct sem *sem); int OSSemV(struct sem *sem);
struct tcb *OSSpawn(char *text, code, int size, int one, int one); int OSReady(struct tcb *task); int OSGetUID(struct tcb *task);
int OSReschedule(void); int OSSuspend(struct tcb *task); int OSRun(struct tcb *task); int OSForbid(void); int OSPermit(void);
int OSKill(struct tcb *task); int OSPanic(unread); int OSExit(unread);
";

/// The task of the RoBIOS 6 program.
const TASK_6: &str = "static void code(void) { OSReschedule(); while (1) OSYield(); }\n";

/// Constants named in the sources of RoBIOS-7. The tests add those of the simulator's headers.
const CONSTANTS_7: &str = "QQVGA QVGA VGA CAM1MP CAMHD CAM5MP CUSTOM RED GREEN BLUE WHITE GRAY BLACK SILVER LIGHTGRAY DARKGRAY NAVY \
    CYAN TEAL MAGENTA PURPLE MAROON YELLOW OLIVE ORANGE NOKEY KEY1 KEY2 KEY3 KEY4 ANYKEY KEY_INVALID KEY_LIST1 KEY_LIST2 KEY_LIST3 \
    KEY_LIST4 KEY_LIST5 KEY_LIST6 KEY_LIST7 KEY_LIST8 KEY_LISTDN KEY_LISTUP KEY_LISTTL KEY_ESCAPE KEYTM_UNKNOWN KEYTM_CLASSIC \
    KEYTM_STANDARD KEYTM_REGIONS KEYTM_LISTMENU HELVETICA TIMES COURIER NORMAL BOLD ITALICS VEHICLE PLATFORM WALKER MACHINE_SPEED \
    MACHINE_TYPE MACHINE_ID IRTV_0 IRTV_9 IRTV_RED IRTV_GREEN IRTV_YELLOW IRTV_BLUE IRTV_LEFT IRTV_RIGHT IRTV_UP IRTV_DOWN IRTV_OK \
    IRTV_POWER LCD_BGCOL_TRANSPARENT LCD_BGCOL_NOTRANSPARENT LCD_BGCOL_INVERSE LCD_BGCOL_NOINVERSE LCD_FGCOL_INVERSE \
    LCD_FGCOL_NOINVERSE LCD_AUTOREFRESH LCD_NOAUTOREFRESH LCD_SCROLLING LCD_NOSCROLLING LCD_LINEFEED LCD_NOLINEFEED LCD_SHOWMENU \
    LCD_HIDEMENU LCD_LISTMENU LCD_CLASSICMENU LCD_FB_ROTATE LCD_FB_NOROTATION PSD_FRONT PSD_LEFT PSD_RIGHT PSD_BACK CAM_SUCCESS \
    CAM_FAILURE";
const SIZES: [&str; 6] = ["QQVGA", "QVGA", "VGA", "CAM1MP", "CAMHD", "CAM5MP"];
const VARIABLES_7: &str =
    "CAMWIDTH CAMHEIGHT CAMPIXELS CAMSIZE CAMMODE IP_WIDTH IP_HEIGHT IP_PIXELS IP_SIZE LIDAR_RESOLUTION";
const CONSTANTS_6: &str = "TRUE FALSE imagecolumns imagerows PSD_FRONT PSD_LEFTDIAG PSD_RIGHTDIAG PSD_LEFT PSD_RIGHT PSD_FRONT2 \
    PSD_BACK BUMP_RIGHT PSD_FRONTLEFT PSD_FRONTRIGHT MOTOR_LEFT MOTOR_RIGHT MOTOR_FL MOTOR_FR MOTOR_BL MOTOR_BR QUAD_LEFT QUAD_RIGHT \
    QUAD_FL SERVO1 VW VW_DRIVE BUMP_LEFT COMPASS KEY1 KEY2 KEY3 KEY4 ANYKEY NORMAL WIDE TELE NOCAM INITERROR COLCAM AUTOBRIGHTNESS \
    NOAUTOBRIGHTNESS FPS60 FPS30 FPS15 FPS7_5 FPS3_75 FPS1_875 FPS0_9375 FPS0_46875 VEHICLE PLATFORM WALKER COOP DEFAULT PREEMPT NOTASK \
    TASK_NEW MAX_PRI MIN_PRI IDLE_PRI IDLE_STACKSIZE SMALL_STACKSIZE DEFAULT_STACKSIZE SER4800 SER9600 SER19200 SER38400 SER57600 \
    SER115200 NONE RTSCTS SERIAL1 SERIAL2 SERIAL3 PSD_OUT_OF_RANGE BROADCAST MAXMSGLEN SCROLLING NONSCROLLING CURSOR NOCURSOR";
const TYPES_6: &str = "BYTE BOOL image colimage DeviceSemantics MotorHandle QuadHandle ServoHandle PSDHandle VWHandle BumpHandle \
    IRHandle TimerHandle meterPerSec radPerSec meter radians PositionType SpeedType TypeID RadioIOParameters RadioStatus";

/// Functions that return a value other than 0 on success.
const NOT_ZERO: &[&str] = &["KEYReadXY", "OSExecute", "AUPlay", "ANALOGRecord", "IRTVFlush", "USRResident"];

/// A function of a header: its name, return type, and the types and names of its parameters.
struct Signature {
    name: &'static str,
    returns: &'static str,
    parameters: Vec<(&'static str, &'static str)>,
}

fn signatures(text: &'static str) -> Vec<Signature> {
    let signature = |text: &'static str| {
        let (head, parameters) = text.trim().split_once('(')?;
        let name = head.rsplit([' ', '*']).next()?;
        let parameters = parameters.trim_end_matches(')').split(", ").filter(|text| *text != "void");
        let parameter = |text: &'static str| {
            let name = text.rsplit([' ', '*']).next().unwrap_or(text);
            let kind = text[..text.len() - name.len()].trim();
            if kind.is_empty() { (text, text) } else { (kind, name) }
        };
        let returns = head[..head.len() - name.len()].trim();
        Some(Signature { name, returns, parameters: parameters.map(parameter).collect() })
    };
    text.split(';').filter_map(signature).collect()
}

/// An integer that is valid for the parameter with this name.
fn number(name: &str) -> i32 {
    match name {
        "zero" | "closed" | "fill" | "tilt" | "z" | "font" => 0,
        "qvga" | "id" | "interface" | "pos" | "handshake" | "one" => 1,
        "servo" | "motor" | "quad" | "io" | "channel" | "state" => 1,
        "key" => -1,
        "psd" | "size" => 2,
        "object" | "row" | "column" => 3,
        "twelve" => 12,
        "x2" | "y2" => 20,
        "level" | "capacity" => 128,
        "xs" => 320,
        "ys" => 240,
        "baud" => 9600,
        "scale" => 1000,
        "points" | "range" => 360,
        "freq" => 8000,
        _ => 10,
    }
}

/// A program, and the name that each of its lines uses.
#[derive(Default)]
struct Program {
    text: String,
    names: Vec<&'static str>,
}

impl Program {
    fn add(&mut self, name: &'static str, code: &str) {
        for line in code.lines() {
            self.text += line;
            self.text += "\n";
            self.names.push(name);
        }
    }

    /// Runs the program and asserts that all names work. Names that fail are found in its output, or by the line
    /// numbers in a compiler's message or a crash report.
    fn run(&self, file: &str, sim: &str, args: &[&str]) -> Ran {
        let scratch = Scratch::new();
        scratch.write(file, &self.text);
        scratch.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
        scratch.write("all.robi", ROBI_6);
        scratch.write("all.toml", COMPANION_6);
        scratch.write("all.sim", &format!("world room.wld\n{}", sim.replace("FILE", file)));
        let press = |at: u32| format!("{at}:KEY1, {at}.2:TOUCH(100,100), {at}.4:IRTV_OK");
        let keys: Vec<String> = (1..100).map(press).collect();
        let ran = scratch.eyesim(&[&["run", "all.sim", "--keys", &keys.join(", "), "--until", "300"], args].concat());
        let said = format!("{}\n{}", ran.stdout, ran.stderr);
        let mut failed: BTreeSet<&str> =
            said.lines().filter_map(|line| Some(line.strip_prefix("[r")?.split_once("failed: ")?.1)).collect();
        let mark = format!("{file}:");
        let mentions = said.split(&mark).skip(1);
        let lines = mentions.filter_map(|rest| rest.split(|c: char| !c.is_ascii_digit()).next()?.parse::<usize>().ok());
        if ran.code != Some(0) {
            failed.extend(lines.filter_map(|line| self.names.get(line - 1)));
        }
        let is_well = failed.is_empty() && ran.code == Some(0) && said.contains("all called");
        assert!(is_well, "failed: {failed:#?}\nexit {:?}\n{said}", ran.code);
        ran
    }
}

/// Returns true if the documentation of the function promises 0 on success.
fn returns_zero(functions: &[&Function], name: &str) -> bool {
    let is_zero = |function: &&&Function| {
        function.name == name && ["Returns 0.", "Returns 0,"].iter().any(|text| function.doc.concat().contains(text))
    };
    !NOT_ZERO.contains(&name) && functions.iter().any(|function| is_zero(&function))
}

fn functions_7() -> Vec<&'static Function> {
    Robios7Call::ALL.iter().map(|call| call.function()).collect()
}

fn functions_6() -> Vec<&'static Function> {
    Robios6Call::ALL.iter().map(|call| call.function()).collect()
}

// ---- C and C++ ----

/// Argument that a C program passes: of the declared type, or of a type that C converts to it.
fn argument_in_c(kind: &str, name: &str, is_loose: bool) -> String {
    let pick = |strict: &str, loose: &str| if is_loose { loose } else { strict }.to_owned();
    let whole = number(name);
    match kind {
        "int" if is_loose => match name.len() % 5 {
            0 => format!("(short){whole}"),
            1 => format!("{whole}.4"),
            2 => format!("{whole}u"),
            3 => format!("{whole}L"),
            _ => format!("(float){whole}"),
        },
        "int" | "long" | "uint32_t" | "BOOL" => whole.to_string(),
        "float" | "meter" | "meterPerSec" | "radians" | "radPerSec" => pick("0.2f", "0.2"),
        "COLOR" => pick("RED", "(unsigned)RED"),
        "BYTE" => pick(&whole.to_string(), &format!("{whole}.2")),
        "char" => pick("'o'", "111"),
        "DeviceSemantics" | "TypeID" => name.to_owned(),
        "TIMER" => "timer".to_owned(),
        "fct" | "TimerFnc" => pick("tick", "(void *)tick"),
        "code" => pick("code", "&code"),
        "sema" => "&sema".to_owned(),
        "menu" => "&menu".to_owned(),
        "TASK" => "spawned".to_owned(),
        "MotorHandle" | "QuadHandle" | "ServoHandle" | "PSDHandle" | "VWHandle" | "BumpHandle" | "IRHandle"
        | "TimerHandle" => name.to_owned(),
        "struct tcb *" => "spawned".to_owned(),
        "struct sem *" => "&semaphore".to_owned(),
        "image *" => {
            if name == "dest" {
                pick("&edges", "edges")
            } else {
                pick("&grey", "grey")
            }
        }
        "colimage *" => pick("&colour", "colour"),
        "int *" if name == "scan" || name == "list" => pick("numbers", "(void *)numbers"),
        "int *" => pick("&whole", if name.len().is_multiple_of(2) { "&natural" } else { "numbers" }),
        "BYTE *" if name == "bits" || name == "sender" => pick("text", "(char *)text"),
        "BYTE *" if name.starts_with("img") => pick("colour", if name == "img" { "&colour" } else { "rows" }),
        "BYTE *" if name == "g" || name == "gOut" => pick("grey", "(char *)grey"),
        "BYTE *" if name == "buf" => pick("buffer", "&buffer"),
        "BYTE *" => pick("&byte", "(char *)&byte"),
        "unsigned char *" => pick("text", "(char *)text"),
        "const char *" | "char *" => match name {
            "buf" | "out" => pick("(char *)buffer", "buffer"),
            "filename" => "(char *)\"a.ppm\"".to_owned(),
            "grayname" => "(char *)\"a.pgm\"".to_owned(),
            "command" => "(char *)\"true\"".to_owned(),
            _ => pick("(char *)\"text\"", "buffer"),
        },
        _ if kind.ends_with('*') => format!("&{name}"),
        _ => unreachable!("no argument is known for `{kind} {name}`"),
    }
}

/// Variable that keeps the result of a function for later calls.
fn kept(name: &str) -> Option<&'static str> {
    let pairs = [
        ("OSAttachTimer", "timer"),
        ("MOTORInit", "motor"),
        ("QUADInit", "quad"),
        ("SERVOInit", "servo"),
        ("PSDInit", "psd"),
        ("VWInit", "vw"),
        ("BUMPInit", "bump"),
        ("IRInit", "ir"),
        ("OSSpawn", "spawned"),
    ];
    pairs.iter().find(|(function, _)| *function == name).map(|(_, variable)| *variable)
}

fn call_in_c(signature: &Signature, functions: &[&Function], is_loose: bool) -> String {
    let Signature { name, returns, parameters } = signature;
    if parameters.iter().any(|(kind, _)| *kind == "unread") {
        let arguments = ["", "(char *)\"text\"", "0"]
            [["IRTVGet", "OSPanic", "OSExit"].iter().position(|n| n == name).expect("a place")];
        return format!("if (sum == -1) {name}({arguments});");
    }
    let arguments: Vec<String> = parameters.iter().map(|(kind, name)| argument_in_c(kind, name, is_loose)).collect();
    let call = format!("{name}({})", arguments.join(", "));
    if let Some(variable) = kept(name) {
        return format!("{variable} = {call}; if (!{variable}) puts(\"failed: {name}\");");
    }
    match *returns {
        "void" => format!("{call};"),
        _ if returns.ends_with('*') => format!("sum += {call} != NULL;"),
        _ if returns_zero(functions, name) => format!("if ({call} != 0) puts(\"failed: {name}\");"),
        _ => format!("{{ double result = {call}; sum += result > 0; }}"),
    }
}

/// Uses each constant where C requires a compile-time constant.
fn add_constants(program: &mut Program, constants: impl IntoIterator<Item = &'static str>) {
    for name in constants.into_iter().collect::<BTreeSet<_>>() {
        program.add(name, &format!("enum {{ use_{name} = (int){name} }};"));
    }
}

const OPENING_7: &str = "static BYTE colour[QVGA_SIZE], rows[QVGA_Y][QVGA_X][3], grey[QVGA_PIXELS], byte;
static int whole, numbers[65536]; static unsigned natural; static unsigned char text[4096], buffer[65536]; static SEMA sema;
static TIMER timer; static listmenu_t menu; static TASK spawned; static QVGAcol image7; static QQVGAgray gray7;
static void tick(void) { whole++; }
static void *task(void *data) { OSWait(1000000); return data; }
int main(void)
{
    long sum = sizeof(DeviceSemantics) + sizeof(COLOR) + sizeof(image7) + sizeof(gray7) + sizeof MACHINE_NAME + sizeof VERSION;
    usleep(10); sum += (int)sqrt(M_PI) + (int)time(NULL) * 0 + errno * 0 + SIGINT * 0 + True + False;
    { struct timeval t; gettimeofday(&t, NULL); sum += (int)t.tv_sec * 0; } { sem_t s; sem_init(&s, 0, 1); sem_wait(&s); }
    buffer[0] = 't'; spawned = MTSpawn(task, 3); (void)rows; (void)natural;";

fn program_7(header: &str, is_loose: bool) -> Program {
    let mut program = Program::default();
    program.add("eyebot.h", &format!("#include \"{header}\""));
    let ours = robios7::CONSTANTS.iter().map(|constant| constant.name);
    add_constants(&mut program, CONSTANTS_7.split_whitespace().chain(ours));
    for size in SIZES {
        let sizes = format!("{size}_X * {size}_Y == {size}_PIXELS && {size}_PIXELS * 3 == {size}_SIZE");
        program.add(size, &format!("typedef char use_{size}_sizes[{sizes} ? 1 : -1];\ntypedef {size}col c_{size}[2]; typedef {size}gray g_{size};"));
    }
    program.add("types.h", OPENING_7);
    VARIABLES_7.split_whitespace().for_each(|name| program.add(name, &format!("sum += {name};")));
    for signature in signatures(FUNCTIONS_7).iter().chain(&signatures(ONLY_C_7)) {
        program.add(signature.name, &call_in_c(signature, &functions_7(), is_loose));
    }
    program.add("main", "printf(\"all called %d\\n\", sum > 0); return 0; }");
    program
}

const ROBI_6: &str = "name All\ndiameter 180\nspeed 600\nturn 300\naxis 0\npsd PSD_FRONT -200 60 0 30 0\ncamera 60 0 100 0 -10 160 120\n\
    wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
const COMPANION_6: &str = "[serial]\n1 = \"loopback\"\n[compass]\n[[bumper]]\nname = \"BUMP_FRONT\"\nfrom_deg = -45\nto_deg = 45\n\
    [[infrared]]\nname = \"IR_FRONT\"\n[[servo]]\nname = \"SERVO1\"\n";

const OPENING_6: &str =
    "static image grey, edges; static colimage colour; static int whole, numbers[100]; static unsigned natural;
static BYTE text[1024], buffer[65536]; static PositionType pos; static SpeedType speed; static RadioIOParameters radio;
static RadioStatus status; static HDT_entry_type entry; static struct sem semaphore; static struct tcb *spawned;
static MotorHandle motor; static QuadHandle quad; static ServoHandle servo; static PSDHandle psd; static VWHandle vw;
static BumpHandle bump; static IRHandle ir; static TimerHandle timer;
static void tick(void) { whole++; }";

fn program_6(is_loose: bool) -> Program {
    let mut program = Program::default();
    program.add("eyebot.h", "#include \"eyebot.h\"\n#include \"hdt.h\"\n#include <stdio.h>");
    let ours = [robios6::CONSTANTS, semantics::SEMANTICS, hdt_type::HDT_TYPES].concat();
    add_constants(&mut program, CONSTANTS_6.split_whitespace().chain(ours.iter().map(|constant| constant.name)));
    for name in TYPES_6.split_whitespace() {
        program.add(name, &format!("typedef {name} use_{name};"));
    }
    program.add("types.h", OPENING_6);
    program.add("OSYield", TASK_6);
    program.add("main", "int main(void)\n{\n    long sum = 0; buffer[0] = 't'; (void)natural; (void)numbers;");
    for signature in &signatures(FUNCTIONS_6) {
        program.add(signature.name, &call_in_c(signature, &functions_6(), is_loose));
    }
    program
        .add("main", "sum += pos.x + pos.y + pos.phi + speed.v + speed.w + radio.id + radio.speed + radio.interface;");
    program.add("main", "printf(\"all called %d\\n\", sum > 0); return 0; }");
    program
}

const SIM_7: &str = "S4 1000 1000 0 FILE\nS4 1000 3000 0 FILE\ncan 3000 3000 0\n";
const SIM_6: &str = "robi all.robi FILE 1000 1000 0\nrobi all.robi FILE 3000 3000 0\n";

#[test]
fn every_name_of_robios_7_is_used_in_c() {
    let ran = program_7("eyebot.h", false).run("all.c", SIM_7, &[]);
    assert!(!ran.stderr.contains("warning"), "{ran:#?}");
}

#[test]
fn every_name_of_robios_7_takes_arguments_that_c_converts() {
    program_7("eyebot.h", true).run("all.c", SIM_7, &["--api", "7"]);
}

#[test]
fn every_name_of_robios_7_is_used_in_cpp() {
    program_7("eyebot++.h", false).run("all.cpp", SIM_7, &[]);
}

#[test]
fn every_name_of_robios_6_is_used_in_c() {
    program_6(false).run("all.c", SIM_6, &[]);
}

#[test]
fn every_name_of_robios_6_takes_arguments_that_c_converts() {
    program_6(true).run("all.c", SIM_6, &[]);
}

#[test]
fn every_name_of_robios_6_is_used_in_cpp() {
    program_6(false).run("all.cpp", SIM_6, &[]);
}

#[test]
fn every_function_of_our_lists_is_used() {
    let own = ["LEG", "CAMGetDepth", "CAMGetLabels", "PSDGetSignal", "LCDListLine", "LIDARScan", "OSError", "OSYield"];
    for (ours, text) in [(functions_7(), FUNCTIONS_7), (functions_6(), FUNCTIONS_6)] {
        let used: BTreeSet<&str> = signatures(text).iter().map(|signature| signature.name).collect();
        let is_missing = |name: &&str| !used.contains(name) && !own.iter().any(|own| name.starts_with(own));
        let missing: Vec<&str> = ours.iter().map(|function| function.name).filter(is_missing).collect();
        assert!(missing.is_empty(), "{missing:?}");
    }
}

// ---- Python ----

/// Types of arguments; the last two need numpy.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// Numbers and texts of Python; outputs are returned instead of written through pointers.
    Plain,
    /// ctypes values, references and arrays.
    Ctypes,
    /// ctypes values of another kind, and pointers.
    Pointer,
    /// Lists and bytes.
    List,
    /// numpy arrays and numbers.
    Numpy,
    /// Pointers to numpy arrays.
    NumpyPointer,
}

const FORMS: [Form; 6] = [Form::Plain, Form::Ctypes, Form::Pointer, Form::List, Form::Numpy, Form::NumpyPointer];

/// Role of a parameter in Python.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Number,
    Colour,
    Letter,
    Text,
    Function,
    Timer,
    Image(&'static str),
    OutNumber(&'static str),
    OutNumbers,
    OutText,
    OutImage(&'static str),
}

fn role(kind: &str, name: &str) -> Role {
    match (kind, name) {
        (_, "scan" | "list") => Role::OutNumbers,
        (_, "id_no") => Role::OutNumber("int"),
        ("int *", _) => Role::OutNumber("int"),
        ("COLOR", _) => Role::Colour,
        ("char", _) => Role::Letter,
        ("fct", _) => Role::Function,
        ("TIMER", _) => Role::Timer,
        ("BYTE *", "img") => Role::Image("SIZE"),
        ("BYTE *", "g") => Role::Image("PIXELS"),
        ("BYTE *", "imgOut") => Role::OutImage("SIZE"),
        ("BYTE *", "gOut") => Role::OutImage("PIXELS"),
        ("BYTE *", _) => Role::OutNumber("ubyte"),
        (_, "buf" | "out") => Role::OutText,
        ("char *" | "const char *", _) => Role::Text,
        _ => Role::Number,
    }
}

fn argument_in_python(role: Role, name: &str, form: Form) -> String {
    use Form::*;
    let of = |texts: [&str; 6]| texts[FORMS.iter().position(|own| *own == form).expect("a form")].to_owned();
    let (whole, text) = (
        number(name),
        match name {
            "filename" => "a.ppm",
            "grayname" => "a.pgm",
            "command" => "true",
            _ => "text",
        },
    );
    match role {
        Role::Number if form == Plain => whole.to_string(),
        Role::Number => format!("{}({whole})", of(["int", "c_int", "c_short", "int", "np.int64", "np.int32"])),
        Role::Colour => of(["RED", "c_int(RED)", "c_uint(RED)", "0xFF0000", "np.int64(RED)", "np.int32(RED)"]),
        Role::Letter => of(["'o'", "b'o'", "c_char(b'o')", "'o'", "'o'", "b'o'"]),
        Role::Text => match form {
            Ctypes => format!("b\"{text}\""),
            Pointer => format!("c_char_p(b\"{text}\")"),
            List => format!("create_string_buffer(b\"{text}\")"),
            _ => format!("\"{text}\""),
        },
        Role::Function => {
            of(["tick", "CFUNCTYPE(None)(tick)", "CFUNCTYPE(None)(lambda: None)", "lambda: None", "tick", "tick"])
        }
        Role::Timer => "timer".to_owned(),
        Role::Image(size) | Role::OutImage(size) => {
            let shape = if size == "SIZE" { "(240, 320, 3)" } else { "(240, 320)" };
            match form {
                Plain if size == "SIZE" => "colour".to_owned(),
                Plain => "grey".to_owned(),
                Ctypes => format!("(c_byte * QVGA_{size})()"),
                Pointer => format!("cast((c_ubyte * QVGA_{size})(), POINTER(c_byte))"),
                List => format!("bytearray(QVGA_{size})"),
                Numpy => format!("np.zeros({shape}, np.uint8)"),
                NumpyPointer => format!("np.zeros({shape}, np.uint8).ctypes.data_as(POINTER(c_byte))"),
            }
        }
        Role::OutNumber(kind) => {
            let array = if kind == "int" { "np.zeros(1, np.int32)" } else { "np.zeros(1, np.uint8)" };
            match form {
                Plain => String::new(),
                Ctypes => format!("byref(c_{kind}())"),
                Pointer => format!("pointer(c_{kind}())"),
                List => format!("(c_{kind} * 1)()"),
                Numpy => array.to_owned(),
                NumpyPointer => format!("{array}.ctypes.data_as(POINTER(c_{kind}))"),
            }
        }
        Role::OutNumbers => of([
            "",
            "(c_int * 65536)()",
            "cast((c_int * 65536)(), POINTER(c_int))",
            "[0] * 65536",
            "np.zeros(65536, np.int32)",
            "np.zeros(65536, np.int32).ctypes.data_as(POINTER(c_int))",
        ]),
        Role::OutText => of([
            "",
            "create_string_buffer(4096)",
            "cast(create_string_buffer(4096), POINTER(c_char))",
            "bytearray(4096)",
            "np.zeros(4096, np.uint8)",
            "np.zeros(4096, np.uint8).ctypes.data_as(c_char_p)",
        ]),
    }
}

/// Operations that must work with results, since they work with those of EyeSim VR.
const USES: &str = r#"
from eye import *
import eye, json, math, struct, sys
try:
    import numpy as np
except ImportError:
    np = None
failed = []
def wrong(name, form, error):
    failed.append(name)
    print("failed:", name, "in form", form, "-", type(error).__name__, error)
def number(r):
    assert int(r) == r == r.value == c_int(r).value and "%d" % r == "%d" % r.value == f"{r:d}" == str(r)
    [0][r * 0], json.dumps(r), struct.pack("<q", r), math.floor(r), round(r), abs(r), -r, r // 1, r & 1, {r: 1}[r]
    assert r + 0 == r and isinstance(r, int) and sorted([r, 0]) is not None and (r == 0) == (not r)
def values(r, count):
    assert len(r) == count and list(r) == [x for x in r] == [r[i] for i in range(count)] and r[-1] == list(r)[-1]
    [number(x) for x in r], "%d " * count % tuple(r), json.dumps(list(r)), str(r), r[0] + 0, r == list(r), r[:2]
    assert r == tuple(r)
    r[0] = 3
    assert r[0] == 3
    if np is not None:
        assert np.array(r).shape == (count,) and np.array(r)[0] == 3
def text(r):
    assert "%s" % r == r + "" and len(r) >= 0 and r.split() is not None
def numbers(r):
    assert all(int(x) == x for x in r) and len(r[0:3]) == min(3, len(r)) and json.dumps(r) and list(r) == r
    if len(r):
        assert min(r) <= sum(r) and r.index(r[0]) == 0 and cast(r, POINTER(c_int))[0] == r[0]
        assert "%d" % r[0] == str(r[0]) == str(int(r[0])) and c_int(r[0]).value == r[0]
    if np is not None:
        assert np.array(r).shape == (len(r),)
def image(r, size):
    assert len(r) == size and 0 <= r[0] <= 255 and len(r[0:3]) == 3 and len(r[0::3]) == (size + 2) // 3
    assert bytes(r)[0] == r[0] and bytearray(r)[5] == list(r)[5] == r[5] and len(memoryview(r)) == sizeof(r) == size
    assert cast(r, POINTER(c_ubyte))[7] == r[7] and max(r) >= min(r) and r[-1] == list(r)[-1] and addressof(r)
    byref(r), pointer(r), struct.unpack_from("BBB", r), int(r[0]) + r[1], memmove((c_byte * size)(), r, size)
    r[0] = 255
    assert r[0] == 255 and r[0] - 256 == -1
    (lib.LCDImage if size == QVGA_SIZE else lib.LCDImageGray)(r)
    if np is not None:
        a, b = np.frombuffer(r, np.uint8), np.ctypeslib.as_array(r)
        assert a.shape == b.shape == np.array(r).shape == np.asarray(r).shape == np.array(r[:]).shape == (size,)
        assert np.fromiter(r, np.uint8)[0] == 255 and np.array(list(r))[0] == 255 and a[0] == b[0] == 255
        assert (a.reshape(QVGA_Y, QVGA_X, size // QVGA_PIXELS).mean(axis=2) >= 0).all() and bytes(a) == bytes(r)
def tick():
    pass
timer = 0
colour, grey = (c_byte * QVGA_SIZE)(), (c_byte * QVGA_PIXELS)()
"#;

fn add_block(program: &mut Program, name: &'static str, form: &str, lines: &[String]) {
    let body: String = lines.iter().map(|line| format!("    {line}\n")).collect();
    program.add(name, &format!("try:\n{body}except Exception as error:\n    wrong('{name}', '{form}', error)"));
}

fn program_in_python() -> Program {
    let mut program = Program::default();
    program.add("eye.py", USES);
    let ours = robios7::CONSTANTS.iter().map(|constant| constant.name);
    let constants = CONSTANTS_7.split_whitespace().chain(VARIABLES_7.split_whitespace()).chain(ours);
    for name in constants {
        let code = format!("assert {name} + 0 == eye.{name} == int({name}) and [0][{name} * 0] == 0 and '%d' % {name}");
        add_block(&mut program, name, "constant", &[code]);
    }
    for size in SIZES {
        let sizes = format!(
            "assert {size}_X * {size}_Y == {size}_PIXELS and {size}_PIXELS * 3 == {size}_SIZE == CAMSIZEARR[{size}]"
        );
        let arrays = format!("CAMPIXELSARR[{size}], CAMWIDTHARR[{size}], CAMHEIGHTARR[{size}], (c_byte * {size}_SIZE)");
        add_block(&mut program, size, "constant", &[sizes, arrays]);
    }
    for signature in &signatures(FUNCTIONS_7) {
        add_python_calls(&mut program, signature);
    }
    program.add("main", "print('all called' if not failed else 'not all', np is not None)\nsys.exit(len(failed) > 0)");
    program
}

/// Calls a function with each type of argument, and uses its result.
fn add_python_calls(program: &mut Program, signature: &Signature) {
    let Signature { name, returns, parameters } = signature;
    let roles: Vec<(Role, &str)> = parameters.iter().map(|(kind, name)| (role(kind, name), *name)).collect();
    let is_out =
        |role: &Role| matches!(role, Role::OutNumber(_) | Role::OutNumbers | Role::OutText | Role::OutImage(_));
    for form in FORMS {
        let is_plain = form == Form::Plain;
        let mut is_given = roles.iter().filter(|(role, name)| !is_plain || !is_out(role) || *name == "id_no");
        let arguments: Vec<String> =
            is_given.by_ref().map(|(role, name)| argument_in_python(*role, name, form)).collect();
        let mut call = format!("{name}({})", arguments.join(", "));
        if *name == "OSAttachTimer" {
            call = format!("timer = {call}; r = timer; number(OSDetachTimer(r)); timer = {call}");
        }
        let outs: Vec<Role> = roles.iter().map(|(role, _)| *role).filter(is_out).collect();
        let uses = match (is_plain, outs.first()) {
            (true, Some(Role::OutNumber(_))) if *name == "KEYReadXY" => "assert r is None or len(r) == 2".to_owned(),
            (true, Some(Role::OutNumber(_))) if *name == "RADIOCheck" => "number(r)".to_owned(),
            (true, _) if *name == "RADIOReceive" => "number(r[0]), text(r[1])".to_owned(),
            // `SIMGetObject` returns four numbers if it is unpacked into four names (tested below), otherwise three as
            // in EyeSim VR.
            (true, Some(Role::OutNumber(_))) if *name == "SIMGetObject" => "values(r, 3)".to_owned(),
            (true, Some(Role::OutNumber(_))) => format!("values(r, {})", outs.len()),
            (true, Some(Role::OutText)) if *name == "SERReceive" => "r.decode()".to_owned(),
            (true, Some(Role::OutText)) => "text(r)".to_owned(),
            (true, Some(Role::OutNumbers)) => "numbers(r)".to_owned(),
            (true, Some(Role::OutImage(_))) if ["AURecord", "ANALOGTransfer"].contains(name) => {
                "len(r), bytes(r)".to_owned()
            }
            (true, Some(Role::OutImage(_))) if outs.len() > 1 => "[image(x, QVGA_PIXELS) for x in r]".to_owned(),
            (true, Some(Role::OutImage(size))) => format!("image(r, QVGA_{size})"),
            _ if *returns == "void" => "r is None or number(c_int(r))".to_owned(),
            _ if is_plain && returns_zero(&functions_7(), name) => "number(r); assert r == 0, r".to_owned(),
            _ => "number(r)".to_owned(),
        };
        let uses = if *returns == "void" && !is_plain { "r".to_owned() } else { uses };
        let mut lines = vec![format!("r = {call}"), uses];
        let names: Vec<String> = (0..outs.len()).map(|index| format!("v{index}")).collect();
        if is_plain && outs.len() > 1 && !["KEYReadXY", "KEYGetXY", "RADIOReceive"].contains(name) {
            lines.push(format!("{} = {call}", names.join(", ")));
            lines.push(format!("[{}] = {call}", names.join(", ")));
        }
        let is_once = [
            "KEYGet",
            "KEYWait",
            "KEYGetXY",
            "IRTVGet",
            "OSAttachTimer",
            "RADIOReceive",
            "SERReceiveChar",
            "CAMRelease",
            "RADIORelease",
            "SERClose",
        ];
        if matches!(form, Form::Ctypes | Form::Pointer | Form::NumpyPointer) && !is_once.contains(name) {
            lines.push(format!("lib.{call}"));
            lines.push(format!("lib.{name}.restype = c_int; int(lib.{call})"));
        }
        if matches!(form, Form::Numpy | Form::NumpyPointer) {
            lines = vec!["if np is not None:".to_owned()]
                .into_iter()
                .chain(lines.iter().map(|line| format!("    {line}")))
                .collect();
        }
        if is_plain && *name == "CAMGet" {
            lines.push("colour = CAMGet()".to_owned());
        }
        if is_plain && *name == "CAMGetGray" {
            lines.push("grey = CAMGetGray()".to_owned());
        }
        add_block(program, name, form_name(form), &lines);
    }
}

fn form_name(form: Form) -> &'static str {
    match form {
        Form::Plain => "plain",
        Form::Ctypes => "ctypes",
        Form::Pointer => "pointer",
        Form::List => "list",
        Form::Numpy => "numpy",
        Form::NumpyPointer => "pointer of numpy",
    }
}

#[test]
fn every_name_of_eye_py_is_used_in_each_form() {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    if !std::process::Command::new(&python).arg("--version").output().is_ok_and(|out| out.status.success()) {
        println!("skipped: there is no `{python}`");
        return;
    }
    let ran = program_in_python().run("all.py", SIM_7, &[]);
    if !ran.stdout.contains("all called True") {
        println!("skipped the forms of numpy: `{python}` has none");
    }
}
