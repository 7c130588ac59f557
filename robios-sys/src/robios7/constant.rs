//! The constants of RoBIOS-7, with the numbers of its headers.

use super::Color;
use crate::constant::constants;

constants! {
    /// Constants of `types.h`.
    list CONSTANTS;

    /// 160 x 120 pixels.
    QQVGA: i32 = 0;
    /// 320 x 240 pixels.
    QVGA: i32 = 1;
    /// 640 x 480 pixels.
    VGA: i32 = 2;
    /// 1296 x 730 pixels.
    CAM1MP: i32 = 3;
    /// 1920 x 1080 pixels.
    CAMHD: i32 = 4;
    /// 2592 x 1944 pixels.
    CAM5MP: i32 = 5;
    /// The size that the program has written to `CAMWIDTH` and `CAMHEIGHT`, or to `IP_WIDTH` and `IP_HEIGHT`.
    CUSTOM: i32 = 10;

    /// `CAMGetLabels`: nothing.
    CAM_SKY: i32 = 0;
    /// `CAMGetLabels`: the floor, with what is painted on it, or a terrain.
    CAM_FLOOR: i32 = 1;
    /// `CAMGetLabels`: a wall.
    CAM_WALL: i32 = 2;
    /// `CAMGetLabels`: robot or object n is this + n.
    CAM_BODY: i32 = 10;

    /// Colour of 255, 0, 0.
    RED: Color = 0xFF0000;
    /// Colour of 0, 255, 0.
    GREEN: Color = 0x00FF00;
    /// Colour of 0, 0, 255.
    BLUE: Color = 0x0000FF;
    /// Colour of 255, 255, 255.
    WHITE: Color = 0xFFFFFF;
    /// Colour of 128, 128, 128.
    GRAY: Color = 0x808080;
    /// Colour of 0, 0, 0.
    BLACK: Color = 0x000000;
    /// Colour of 192, 192, 192.
    SILVER: Color = 0xC0C0C0;
    /// Colour of 211, 211, 211.
    LIGHTGRAY: Color = 0xD3D3D3;
    /// Colour of 169, 169, 169.
    DARKGRAY: Color = 0xA9A9A9;
    /// Colour of 0, 0, 128.
    NAVY: Color = 0x000080;
    /// Colour of 0, 238, 238.
    CYAN: Color = 0x00EEEE;
    /// Colour of 0, 128, 128.
    TEAL: Color = 0x008080;
    /// Colour of 255, 0, 255.
    MAGENTA: Color = 0xFF00FF;
    /// Colour of 128, 0, 128.
    PURPLE: Color = 0x800080;
    /// Colour of 128, 0, 0.
    MAROON: Color = 0x800000;
    /// Colour of 255, 255, 0.
    YELLOW: Color = 0xFFFF00;
    /// Colour of 154, 205, 50.
    OLIVE: Color = 0x9ACD32;
    /// Colour of 255, 165, 0.
    ORANGE: Color = 0xFFA500;

    /// No key is pressed.
    NOKEY: i32 = 0;
    /// The left key under the LCD.
    KEY1: i32 = 1;
    /// The second key from the left.
    KEY2: i32 = 2;
    /// The third key from the left.
    KEY3: i32 = 4;
    /// The right key.
    KEY4: i32 = 8;
    /// `KEYWait`: any key.
    ANYKEY: i32 = -1;
    /// No such key.
    KEY_INVALID: i32 = -1;
    /// First line of a list menu.
    KEY_LIST1: i32 = 0x10;
    /// Second line of a list menu.
    KEY_LIST2: i32 = 0x20;
    /// Third line of a list menu.
    KEY_LIST3: i32 = 0x40;
    /// Fourth line of a list menu.
    KEY_LIST4: i32 = 0x80;
    /// Fifth line of a list menu.
    KEY_LIST5: i32 = 0x100;
    /// Sixth line of a list menu.
    KEY_LIST6: i32 = 0x200;
    /// Seventh line of a list menu.
    KEY_LIST7: i32 = 0x400;
    /// Eighth line of a list menu.
    KEY_LIST8: i32 = 0x800;
    /// A list menu's way down.
    KEY_LISTDN: i32 = 0x1000_0000;
    /// A list menu's way up.
    KEY_LISTUP: i32 = 0x2000_0000;
    /// A list menu's title.
    KEY_LISTTL: i32 = 0x4000_0000;
    /// Escape.
    KEY_ESCAPE: i32 = i32::MIN;
    /// Touch map: not known.
    KEYTM_UNKNOWN: i32 = 0;
    /// Touch map: four keys.
    KEYTM_CLASSIC: i32 = 1;
    /// Touch map: standard.
    KEYTM_STANDARD: i32 = 2;
    /// Touch map: regions that the program sets.
    KEYTM_REGIONS: i32 = 3;
    /// Touch map: a list menu.
    KEYTM_LISTMENU: i32 = 4;

    /// `LCDSetFont`: without serifs.
    HELVETICA: i32 = 0;
    /// `LCDSetFont`: with serifs.
    TIMES: i32 = 1;
    /// `LCDSetFont`: all characters of one width.
    COURIER: i32 = 2;
    /// `LCDSetFont`: upright, of normal weight.
    NORMAL: i32 = 0;
    /// `LCDSetFont`: bold.
    BOLD: i32 = 1;
    /// `LCDSetFont`: slanted.
    ITALICS: i32 = 2;

    /// `LCDSetMode`: text is drawn over what is there.
    LCD_BGCOL_TRANSPARENT: i32 = 0x01;
    /// `LCDSetMode`: text has a background.
    LCD_BGCOL_NOTRANSPARENT: i32 = 0x1000;
    /// `LCDSetMode`: the background colour is inverted.
    LCD_BGCOL_INVERSE: i32 = 0x02;
    /// `LCDSetMode`: the background colour is as set.
    LCD_BGCOL_NOINVERSE: i32 = 0x2000;
    /// `LCDSetMode`: the text's colour is inverted.
    LCD_FGCOL_INVERSE: i32 = 0x04;
    /// `LCDSetMode`: the text's colour is as set.
    LCD_FGCOL_NOINVERSE: i32 = 0x4000;
    /// `LCDSetMode`: each call is shown immediately.
    LCD_AUTOREFRESH: i32 = 0x08;
    /// `LCDSetMode`: drawings are shown by `LCDRefresh`.
    LCD_NOAUTOREFRESH: i32 = 0x8000;
    /// `LCDSetMode`: text that leaves the last line moves all lines up.
    LCD_SCROLLING: i32 = 0x10;
    /// `LCDSetMode`: text that leaves the last line starts again in the first.
    LCD_NOSCROLLING: i32 = 0x1_0000;
    /// `LCDSetMode`: the end of a line continues in the next.
    LCD_LINEFEED: i32 = 0x20;
    /// `LCDSetMode`: the end of a line stays in it.
    LCD_NOLINEFEED: i32 = 0x2_0000;
    /// `LCDSetMode`: the menu is shown.
    LCD_SHOWMENU: i32 = 0x40;
    /// `LCDSetMode`: the menu is not shown.
    LCD_HIDEMENU: i32 = 0x4_0000;
    /// `LCDSetMode`: the menu is a list.
    LCD_LISTMENU: i32 = 0x80;
    /// `LCDSetMode`: the menu has four keys.
    LCD_CLASSICMENU: i32 = 0x8_0000;
    /// `LCDSetMode`: the display is turned.
    LCD_FB_ROTATE: i32 = 0x100;
    /// `LCDSetMode`: the display is not turned.
    LCD_FB_NOROTATION: i32 = 0x10_0000;

    /// `OSMachineType`: drives.
    VEHICLE: i32 = 1;
    /// `OSMachineType`: stands on a platform.
    PLATFORM: i32 = 2;
    /// `OSMachineType`: walks.
    WALKER: i32 = 3;

    /// `PSDGet`: the sensor in front.
    PSD_FRONT: i32 = 1;
    /// `PSDGet`: the left sensor.
    PSD_LEFT: i32 = 2;
    /// `PSDGet`: the right sensor.
    PSD_RIGHT: i32 = 3;
    /// `PSDGet`: the sensor at the back.
    PSD_BACK: i32 = 4;

    /// `IRTVGet`: the digit 0; the others follow.
    IRTV_0: i32 = b'0' as i32;
    /// `IRTVGet`: the digit 1.
    IRTV_1: i32 = b'1' as i32;
    /// `IRTVGet`: the digit 2.
    IRTV_2: i32 = b'2' as i32;
    /// `IRTVGet`: the digit 3.
    IRTV_3: i32 = b'3' as i32;
    /// `IRTVGet`: the digit 4.
    IRTV_4: i32 = b'4' as i32;
    /// `IRTVGet`: the digit 5.
    IRTV_5: i32 = b'5' as i32;
    /// `IRTVGet`: the digit 6.
    IRTV_6: i32 = b'6' as i32;
    /// `IRTVGet`: the digit 7.
    IRTV_7: i32 = b'7' as i32;
    /// `IRTVGet`: the digit 8.
    IRTV_8: i32 = b'8' as i32;
    /// `IRTVGet`: the digit 9.
    IRTV_9: i32 = b'9' as i32;
    /// `IRTVGet`: the red key.
    IRTV_RED: i32 = b'R' as i32;
    /// `IRTVGet`: the green key.
    IRTV_GREEN: i32 = b'G' as i32;
    /// `IRTVGet`: the yellow key.
    IRTV_YELLOW: i32 = b'Y' as i32;
    /// `IRTVGet`: the blue key.
    IRTV_BLUE: i32 = b'B' as i32;
    /// `IRTVGet`: left.
    IRTV_LEFT: i32 = b'L' as i32;
    /// `IRTVGet`: right.
    IRTV_RIGHT: i32 = b'>' as i32;
    /// `IRTVGet`: up.
    IRTV_UP: i32 = b'U' as i32;
    /// `IRTVGet`: down.
    IRTV_DOWN: i32 = b'D' as i32;
    /// `IRTVGet`: OK.
    IRTV_OK: i32 = b'O' as i32;
    /// `IRTVGet`: power.
    IRTV_POWER: i32 = b'P' as i32;
}
