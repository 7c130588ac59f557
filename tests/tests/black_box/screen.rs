//! The colour display, keys and touches of RoBIOS-7 in C programs.

use tests::Scratch;

const FIELD: &str = "floor 2000 2000\n0 0 2000 0\n2000 0 2000 2000\n2000 2000 0 2000\n0 2000 0 0\n";
const SIM: &str = "world field.wld\nS4 1000 1000 0 draw.c\n";

/// Writes a scene with a robot that runs a C program whose `main` has the body `body` and returns 0.
fn scene(body: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("field.wld", FIELD);
    scratch.write("draw.sim", SIM);
    scratch.write("draw.c", &format!("#include \"eyebot.h\"\n\nint main(void)\n{{\n{body}\n    return 0;\n}}\n"));
    scratch
}

/// Gives the robot of a scene a display of another size.
fn resize_display(scratch: &Scratch, width: u32, height: u32) {
    scratch.write("s4.robi", "diameter 200\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n");
    scratch.write("s4.toml", &format!("[lcd]\nwidth_px = {width}\nheight_px = {height}\n"));
    scratch.write("draw.sim", &SIM.replace("S4 1000 1000 0 draw.c", "robi s4.robi draw.c 1000 1000 0"));
}

/// Rows of text on the display of robot 1 at the end.
fn rows(report: &serde_json::Value) -> Vec<String> {
    let rows = report["robots"][0]["lcd"].as_array().expect("rows");
    rows.iter().map(|row| row.as_str().expect("text").to_owned()).collect()
}

#[test]
fn text_and_menu_are_reported() {
    let scratch = scene(
        "    int row, column, x, y;
        LCDPrintf(\"one\\ntwo %d\\n\", 2);
        LCDSetPrintf(4, 10, \"x=%.1f\", 1.5);
        LCDGetPos(&row, &column);
        LCDGetSize(&x, &y);
        LCDSetPrintf(5, 0, \"%d %d %d %d\", row, column, x, y);
        LCDMenu(\"GO\", \"\", \"\", \"END\");
        LCDMenuI(2, \"BACK\", WHITE, RED);",
    );
    let report = scratch.report("draw.sim", &[], 0);
    assert_eq!(rows(&report), ["one", "two 2", "", "", "          x=1.5", "4 15 480 320", "GO | BACK |  | END"]);
}

#[test]
fn every_function_draws_as_documented() {
    let scratch = scene(
        "    static BYTE grey[160 * 120], colours[3 * 4], bits[4] = {0, 1, 2, 0};
        int failures = 0;
        #define EXPECT(x, y, col) if (LCDGetPixel(x, y) != (col)) LCDPrintf(\"%d: %06X\\n\", __LINE__, LCDGetPixel(x, y)), failures++
        #define OK(call) if ((call) != 0) LCDPrintf(\"%d\\n\", __LINE__), failures++
        #define BAD(call) if ((call) != 1) LCDPrintf(\"%d\\n\", __LINE__), failures++
        OK(LCDPixel(200, 100, 0x123456)); EXPECT(200, 100, 0x123456); EXPECT(201, 100, BLACK);
        OK(LCDPixelInvert(200, 100)); EXPECT(200, 100, 0xEDCBA9);
        OK(LCDPixel(-1, 5, RED)); OK(LCDPixel(480, 320, RED)); EXPECT(480, 320, BLACK); EXPECT(-2147483647, 0, BLACK);
        OK(LCDLine(210, 100, 220, 110, GREEN)); EXPECT(210, 100, GREEN); EXPECT(215, 105, GREEN); EXPECT(220, 110, GREEN);
        OK(LCDLineInvert(210, 100, 220, 110)); EXPECT(215, 105, MAGENTA);
        OK(LCDLine(-2147483647, 130, 2147483647, 130, NAVY)); EXPECT(0, 130, NAVY); EXPECT(479, 130, NAVY);
        OK(LCDArea(240, 100, 250, 110, ORANGE, 1)); EXPECT(240, 100, ORANGE); EXPECT(250, 110, ORANGE); EXPECT(251, 110, BLACK);
        OK(LCDArea(260, 100, 270, 110, ORANGE, 0)); EXPECT(260, 105, ORANGE); EXPECT(265, 105, BLACK); EXPECT(270, 110, ORANGE);
        OK(LCDAreaInvert(240, 100, 242, 102)); EXPECT(241, 101, 0x005AFF);
        OK(LCDCircle(290, 60, 10, CYAN, 0)); EXPECT(300, 60, CYAN); EXPECT(290, 50, CYAN); EXPECT(290, 60, BLACK); EXPECT(300, 50, BLACK);
        OK(LCDCircle(290, 60, 4, SILVER, 1)); EXPECT(290, 60, SILVER); EXPECT(294, 60, SILVER); EXPECT(295, 60, BLACK);
        OK(LCDCircleInvert(290, 60, 2)); EXPECT(290, 60, 0x3F3F3F); EXPECT(293, 60, SILVER);
        OK(LCDCircle(0, 0, 2147483647, RED, 0)); OK(LCDCircle(5, 5, -1, RED, 1)); EXPECT(5, 5, BLACK);
        colours[0] = 255; colours[10] = 255;
        OK(LCDImageStart(200, 150, 2, 2)); OK(LCDImage(colours)); EXPECT(200, 150, RED); EXPECT(201, 151, GREEN); EXPECT(202, 150, BLACK);
        OK(LCDImageStart(210, 150, 2, 2)); OK(LCDImageBinary(bits)); EXPECT(210, 150, WHITE); EXPECT(211, 150, BLACK); EXPECT(210, 151, BLACK); EXPECT(211, 151, WHITE);
        memset(grey, 77, sizeof grey);
        OK(LCDImageStart(-100, -100, 160, 120)); OK(LCDImageGray(grey)); EXPECT(59, 19, 0x4D4D4D); EXPECT(60, 19, BLACK);
        OK(LCDImageSize(QQVGA)); OK(LCDImageGray(grey)); EXPECT(59, 19, 0x4D4D4D);
        BAD(LCDImageSize(6)); BAD(LCDImageStart(0, 0, 0, 5)); BAD(LCDImageStart(0, 0, 2147483647, 2147483647)); BAD(LCDImage(0));
        OK(LCDSetFont(TIMES, ITALICS)); BAD(LCDSetFont(3, 0)); BAD(LCDSetFont(0, -1)); OK(LCDSetFont(COURIER, NORMAL));
        OK(LCDSetFontSize(24)); BAD(LCDSetFontSize(10)); OK(LCDSetFontSize(12));
        OK(LCDSetColor(BLUE, YELLOW)); OK(LCDSetPos(12, 20)); OK(LCDPrintf(\" \")); EXPECT(120, 156, YELLOW);
        OK(LCDSetColor(WHITE, BLACK)); OK(LCDSetMode(LCD_BGCOL_INVERSE)); OK(LCDSetPrintf(12, 20, \" \")); EXPECT(120, 156, WHITE);
        OK(LCDSetMode(LCD_BGCOL_NOINVERSE)); OK(LCDRefresh());
        BAD(LCDMenuI(0, \"x\", RED, RED)); BAD(LCDMenuI(5, \"x\", RED, RED)); OK(LCDMenuI(4, \"\", BLACK, TEAL)); EXPECT(470, 315, TEAL);
        OK(LCDSetMode(LCD_HIDEMENU)); EXPECT(470, 315, BLACK);
        OK(LCDSetPrintf(-5, 99, \"beside\")); OK(LCDSetPrintf(2147483647, -2147483647, \"beside\"));
        OK(LCDClear()); EXPECT(200, 150, BLACK);
        LCDPrintf(\"failures %d\", failures);",
    );
    scratch.write(
        "draw.c",
        &scratch.read("draw.c").replace("#include \"eyebot.h\"", "#include <string.h>\n#include \"eyebot.h\""),
    );
    let ran = scratch.eyesim(&["run", "draw.sim", "--trace", "t.jsonl"]);
    let texts: Vec<String> = scratch
        .trace("t.jsonl")
        .iter()
        .filter(|line| line["event"] == "lcd_text")
        .map(|line| line["text"].as_str().expect("text").trim().to_owned())
        .filter(|text| !text.is_empty() && text != "beside")
        .collect();
    assert_eq!(texts, ["failures 0"], "{ran:#?}");
}

#[test]
fn keys_and_touches_come_from_the_script() {
    let scratch = scene(
        "    int x = -1, y = -1;
        LCDPrintf(\"read %d\\n\", KEYRead());
        LCDPrintf(\"none %d %d %d\\n\", KEYReadXY(&x, &y), x, y);
        LCDPrintf(\"get %d\\n\", KEYGet());
        LCDPrintf(\"field %d\\n\", KEYGet());
        LCDPrintf(\"xy %d\", KEYGetXY(&x, &y));
        LCDPrintf(\" %d %d\\n\", x, y);
        LCDPrintf(\"wait %d\\n\", KEYWait(KEY4));
        LCDPrintf(\"any %d\\n\", KEYWait(ANYKEY));
        KEYGetXY(&x, &y);
        LCDPrintf(\"key as touch %d %d\\n\", x, y);
        LCDPrintf(\"no key %d\\n\", KEYWait(0));",
    );
    let keys = "1:TOUCH(120,40), 2:KEY2, 3:TOUCH(479,319), 4:KEY1, 5:KEY4, 6:KEY3, 7:KEY1";
    let report = scratch.report("draw.sim", &["--keys", keys], 0);
    assert_eq!(
        rows(&report)[..10],
        [
            "read 0",
            "none 1 -1 -1",
            "get 2",
            "field 8",
            "xy 0 120 40",
            "wait 8",
            "any 4",
            "key as touch 60 304",
            "no key -1",
            ""
        ]
    );
    let waits = scratch.eyesim(&["run", "draw.sim"]);
    assert_eq!(waits.code, Some(1));
    assert!(waits.stderr.contains("waits for any key"), "{waits:#?}");
    let wrong = scratch.eyesim(&["run", "draw.sim", "--keys", "1:TOUCH(1)"]);
    assert_eq!(wrong.code, Some(2));
    assert!(wrong.stderr.contains("`TOUCH(1)` is not a key: expected `KEY1`, `KEY2`, `KEY3`, `KEY4`, `TOUCH(X,Y)`"));
}

/// Reads a picture.
fn picture(scratch: &Scratch, name: &str) -> image::RgbImage {
    image::open(scratch.path().join(name)).expect("a picture").into_rgb8()
}

#[test]
fn a_list_menu_scrolls_and_is_touched() {
    let scratch = scene(
        "    menuitem_t items[9];
        listmenu_t list = {\"Choose\", WHITE, BLUE};
        int i, key, x, y;
        for (i = 0; i < 9; i++) {
            sprintf(items[i].label, \"item %d\", i);
            items[i].fgcol = BLACK;
            items[i].bgcol = LIGHTGRAY;
        }
        list.pitems = items;
        list.size = 9;
        LCDMenu(\"Select\", \"\", \"\", \"Back\");
        LCDList(&list);
        while ((key = KEYGet()) != KEY4) {
            if (key == KEY_LISTDN && list.start < 4) list.start++;
            if (key >= KEY_LIST1 && key <= KEY_LIST8) for (list.index = 0; KEY_LIST1 << list.index != key; list.index++);
            LCDList(&list);
        }
        if (LCDGetList() != &list || !list.scroll) return 1;
        KEYGetXY(&x, &y);
        printf(\"%s %d\\n\", LCDListActiveItem()->label, LCDGetPixel(300, 30) == RED);",
    );
    scratch.write("draw.c", &format!("#include <stdio.h>\n{}", scratch.read("draw.c")));
    resize_display(&scratch, 320, 240);
    // The menu has 208 / 26 = 8 lines: title, up, five items, down.
    let keys = "1:TOUCH(100,190), 2:TOUCH(100,190), 3:TOUCH(100,90), 4:KEY4, 5:TOUCH(160,120)";
    let report = scratch.report("draw.sim", &["--keys", keys, "--trace", "t.jsonl"], 0);
    assert_eq!(
        rows(&report),
        [
            "Choose",
            "SCROLL UP",
            "  item 2",
            "> item 3",
            "  item 4",
            "  item 5",
            "  item 6",
            "SCROLL DOWN",
            "Select |  |  | Back"
        ]
    );
    let trace = scratch.trace("t.jsonl");
    let calls: Vec<&str> =
        trace.iter().filter(|line| line["event"] == "key").map(|line| line["key"].as_str().expect("a name")).collect();
    assert_eq!(calls, ["KEY_LISTDN", "KEY_LISTDN", "KEY_LIST2", "KEY4", "TOUCH(160,120)"]);
    let printed = trace.iter().find(|line| line["event"] == "stdout").expect("a line");
    assert_eq!(printed["text"].as_str().map(str::trim), Some("item 3 1"));
}

#[test]
fn a_shot_shows_the_display_of_either_generation() {
    let scratch = scene(
        "    LCDArea(10, 20, 19, 39, ORANGE, 1);
        OSWait(2000);
        LCDArea(10, 20, 19, 39, NAVY, 1);
        LCDRefresh();
        LCDMenu(\"A\", \"B\", \"C\", \"D\");
        KEYWait(KEY4);",
    );
    scratch.write(
        "old.c",
        "#include \"eyebot.h\"\nint main(void) { LCDSetPixel(3, 5, 1); OSMTStatus(); return KEYWait(KEY1); }\n",
    );
    resize_display(&scratch, 320, 240);
    scratch.write("draw.sim", &format!("{}S4 500 500 0 old.c\n", scratch.read("draw.sim")));
    let shot = |args: &[&str]| scratch.eyesim(&[&["shot", "draw.sim"], args].concat());

    let ran = shot(&["--lcd", "--bare", "--scale", "1", "--at", "1.5", "-o", "early.png"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains("early.png: the display of r1 at 1.500 s, 320 x 240 pixels"), "{ran:#?}");
    let early = picture(&scratch, "early.png");
    assert_eq!(early.dimensions(), (320, 240));
    assert_eq!([early[(10, 20)].0, early[(19, 39)].0, early[(20, 39)].0], [[255, 165, 0], [255, 165, 0], [0; 3]]);

    // A program that waits for a key does not count as a failure here.
    let ran = shot(&["--lcd", "1", "--bare"]);
    assert_eq!((ran.code, ran.stderr.contains("waits")), (Some(0), false), "{ran:#?}");
    let late = picture(&scratch, "lcd.png");
    assert_eq!(late.dimensions(), (640, 480));
    assert_eq!([late[(20, 40)].0, late[(39, 79)].0, late[(40, 79)].0], [[0, 0, 128], [0, 0, 128], [0; 3]]);
    assert_eq!([late[(10, 470)].0, late[(170, 470)].0], [[255, 0, 0], [0, 255, 0]], "the menu");

    let framed = shot(&["--lcd", "--scale", "1", "-o", "framed.png"]);
    assert_eq!(framed.code, Some(0));
    let framed = picture(&scratch, "framed.png");
    assert!(framed.width() > 320 && framed.height() > 240);
    let is_navy = |(x, y): &(u32, u32)| framed[(*x, *y)].0 == [0, 0, 128];
    let navy = (0..framed.width()).flat_map(|x| (0..framed.height()).map(move |y| (x, y))).filter(is_navy).count();
    assert_eq!(navy, 10 * 20);

    let classic = shot(&["--lcd", "r2", "--bare", "--scale", "1", "-o", "classic.png"]);
    assert_eq!(classic.code, Some(0), "{classic:#?}");
    let classic = picture(&scratch, "classic.png");
    assert_eq!(classic.dimensions(), (128, 64));
    let dark = classic.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[0] < 0x40).map(|(x, y, _)| (x, y));
    assert_eq!(dark.collect::<Vec<_>>(), [(5, 3)]);
}

#[test]
fn invalid_shots_are_refused_with_a_reason() {
    let scratch = scene("    LCDPrintf(\"x\");");
    for (args, message) in [
        (&["--lcd", "2"][..], "there is no robot 2: the scene has only robot 1"),
        (&["--lcd", "0"], "expected a robot's number from 1"),
        (&["--lcd", "-o", "x.jpg"], "expected a name that ends in .png"),
        (&["--lcd", "-o", "nowhere/x.png"], "there is no folder"),
    ] {
        let ran = scratch.eyesim(&[&["shot", "draw.sim"], args].concat());
        assert!(ran.code == Some(2) && ran.stderr.contains(message), "{ran:#?}");
    }
    scratch.write(
        "draw.c",
        "#include \"eyebot.h\"\nint main(void) { LCDPrintf(\"x\"); LCDPixel(0, 0, RED); return 3; }\n",
    );
    let failed = scratch.eyesim(&["shot", "draw.sim", "--lcd"]);
    assert!(failed.code == Some(1) && failed.stderr.contains("exit code 3"), "{failed:#?}");
    assert!(scratch.path().join("lcd.png").exists(), "the picture is taken all the same");
}

#[test]
fn the_companion_sets_the_size_of_the_display() {
    let scratch = scene(
        "    int x, y;
        LCDGetSize(&x, &y);
        LCDPixel(399, 299, RED);
        LCDPrintf(\"%d %d %d\", x, y, LCDGetPixel(399, 299) == RED);",
    );
    resize_display(&scratch, 400, 300);
    assert_eq!(rows(&scratch.report("draw.sim", &[], 0)), ["400 300 1", ""]);
}
