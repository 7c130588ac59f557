//! docs/mistakes.md shows the first lines of output that beginners see after common mistakes, in every language.
//!
//! `INSTA_UPDATE=always` updates the page.

use std::fmt::Write as _;
use std::fs;
use std::process::Command;
use std::thread;

use tests::{Scratch, eyesim_path, root};

/// A mistake in one language.
struct Case {
    /// Description of the mistake, the same in all languages.
    mistake: &'static str,
    /// File name of the program: `mine.c`, `mine.cpp`, `mine.py`, or `mine` for the Rust package.
    program: &'static str,
    /// Text of the program; for Rust its statements.
    text: &'static str,
    /// The robot's line in the sim file; by default `S4 500 500 0 PROGRAM`.
    robot: Option<&'static str>,
}

const fn case(mistake: &'static str, program: &'static str, text: &'static str) -> Case {
    Case { mistake, program, text, robot: None }
}

/// A file beside the programs that call `plan`: its name and text.
const MAP: (&str, &str) = ("map.c", "int plan(int way)\n{\n  return way;\n}\n");

const CASES: &[Case] = &[
    case(
        "a misspelt function",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraigt(100, 100);\n  return 0;\n}\n",
    ),
    case("a misspelt function", "mine.cpp", "#include \"eyebot.h\"\nint main()\n{\n  VWStraigt(100, 100);\n}\n"),
    case("a misspelt function", "mine.py", "from eye import *\nVWStraigt(100, 100)\n"),
    case("a misspelt function", "mine", "robot.drive()?.straigt(0.1.metres(), 0.1.metres_per_second())?.wait()?;"),
    case("`eyebot.h` or `eye` not included", "mine.c", "int main(void)\n{\n  VWStraight(100, 100);\n  return 0;\n}\n"),
    case("`eyebot.h` or `eye` not included", "mine.cpp", "int main()\n{\n  VWStraight(100, 100);\n}\n"),
    case("`eyebot.h` or `eye` not included", "mine.py", "VWStraight(100, 100)\n"),
    case("the header or module misspelt", "mine.c", "#include \"eyebott.h\"\nint main(void)\n{\n  return 0;\n}\n"),
    case("the header or module misspelt", "mine.py", "from eyes import *\n"),
    case(
        "a semicolon or colon missing",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(100, 100)\n  return 0;\n}\n",
    ),
    case(
        "a semicolon or colon missing",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  VWStraight(100, 100)\n}\n",
    ),
    case("a semicolon or colon missing", "mine.py", "from eye import *\nwhile True\n    OSWait(100)\n"),
    case("a semicolon or colon missing", "mine", "let near = 0.3.metres()\n    let far = near;"),
    case(
        "a `}` missing",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  while (PSDGet(1) > 200) {\n    OSWait(10);\n  return 0;\n}\n",
    ),
    case(
        "a `}` missing",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  while (PSDGet(1) > 200) {\n    OSWait(10);\n  return 0;\n}\n",
    ),
    case(
        "a `}` too many",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  if (PSDGet(1) < 200)\n    VWSetSpeed(0, 0);\n  }\n  return 0;\n}\n",
    ),
    case(
        "a `}` too many",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  if (PSDGet(1) < 200)\n    VWSetSpeed(0, 0);\n  }\n  return 0;\n}\n",
    ),
    case(
        "a parenthesis missing",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  if (PSDGet(1) < 200 {\n    VWSetSpeed(0, 0);\n  }\n  return 0;\n}\n",
    ),
    case(
        "a parenthesis missing",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  if (PSDGet(1) < 200 {\n    VWSetSpeed(0, 0);\n  }\n  return 0;\n}\n",
    ),
    case(
        "a condition without parentheses",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  while PSDGet(1) > 200 {\n    OSWait(10);\n  }\n  return 0;\n}\n",
    ),
    case(
        "a condition without parentheses",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  while PSDGet(1) > 200 {\n    OSWait(10);\n  }\n  return 0;\n}\n",
    ),
    case(
        "a comma missing",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(100 100);\n  return 0;\n}\n",
    ),
    case(
        "a comma missing",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(100 100);\n  return 0;\n}\n",
    ),
    case(
        "a quote missing",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  LCDPrintf(\"hello\\n);\n  return 0;\n}\n",
    ),
    case(
        "a quote missing",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  LCDPrintf(\"hello\\n);\n  return 0;\n}\n",
    ),
    case("a value missing", "mine.c", "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(100);\n  return 0;\n}\n"),
    case(
        "a value missing",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(100);\n  return 0;\n}\n",
    ),
    case("a value missing", "mine.py", "from eye import *\nVWStraight(100)\n"),
    case("the height of a pose missing", "mine.py", "from eye import *\nSIMSetRobot(1, 700, 600, 90)\n"),
    case(
        "a turn in radians",
        "mine.c",
        "#include \"eyebot.h\"\n#include <math.h>\nint main(void)\n{\n  VWTurn(M_PI / 2, 1);\n  return VWWait();\n}\n",
    ),
    case(
        "a turn in radians",
        "mine.cpp",
        "#include \"eyebot.h\"\n#include <cmath>\nint main()\n{\n  VWTurn(M_PI / 2, 1);\n  VWWait();\n}\n",
    ),
    case("a turn in radians", "mine.py", "from eye import *\nVWTurn(1.57, 1)\nVWWait()\n"),
    case(
        "a variable not declared",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  speed = 300;\n  return VWSetSpeed(speed, 0);\n}\n",
    ),
    case(
        "a variable not declared",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  speed = 300;\n  return VWSetSpeed(speed, 0);\n}\n",
    ),
    case(
        "a value of a wrong type",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int speed = \"fast\";\n  return VWSetSpeed(speed, 0);\n}\n",
    ),
    case(
        "a value of a wrong type",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int speed = \"fast\";\n  return VWSetSpeed(speed, 0);\n}\n",
    ),
    case(
        "an array set by `=`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  char name[10];\n  name = \"S4\";\n  LCDPrintf(\"%s\", name);\n  return 0;\n}\n",
    ),
    case(
        "an array set by `=`",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  char name[10];\n  name = \"S4\";\n  LCDPrintf(\"%s\", name);\n  return 0;\n}\n",
    ),
    case(
        "`=` where `==` is meant",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int key = KEYRead();\n  if (key = KEY1)\n    VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case(
        "`=` where `==` is meant",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int key = KEYRead();\n  if (key = KEY1)\n    VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case(
        "the sides of `=` exchanged",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int way;\n  100 = way;\n  return VWStraight(way, 100);\n}\n",
    ),
    case(
        "the sides of `=` exchanged",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int way;\n  100 = way;\n  return VWStraight(way, 100);\n}\n",
    ),
    case(
        "square brackets around a sensor",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  return PSDGet[1];\n}\n",
    ),
    case(
        "square brackets around a sensor",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  return PSDGet[1];\n}\n",
    ),
    case("square brackets around a sensor", "mine.py", "from eye import *\nPSDGet[1]\n"),
    case(
        "a function used before it is known",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  home();\n  return 0;\n}\nvoid home(void)\n{\n  VWStraight(100, 100);\n}\n",
    ),
    case(
        "a function used before it is known",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  home();\n  return 0;\n}\nvoid home(void)\n{\n  VWStraight(100, 100);\n}\n",
    ),
    case(
        "a function written twice",
        "mine.c",
        "#include \"eyebot.h\"\nint home(void) { return 1; }\nint home(void) { return 2; }\nint main(void)\n{\n  return home();\n}\n",
    ),
    case(
        "a function written twice",
        "mine.cpp",
        "#include \"eyebot.h\"\nint home(void) { return 1; }\nint home(void) { return 2; }\nint main(void)\n{\n  return home();\n}\n",
    ),
    case(
        "a function within a function",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  void home()\n  {\n    VWStraight(100, 100);\n\n  home();\n  return 0;\n}\n",
    ),
    case(
        "a function within a function",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  void home()\n  {\n    VWStraight(100, 100);\n\n  home();\n  return 0;\n}\n",
    ),
    case("a `;` after the name of a function", "mine.c", "#include \"eyebot.h\"\nint main(void);\n{\n  return 0;\n}\n"),
    case(
        "a `;` after the name of a function",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void);\n{\n  return 0;\n}\n",
    ),
    case(
        "a number with a comma",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  double v = 0,5;\n  return v > 1;\n  return 0;\n}\n",
    ),
    case(
        "a number with a comma",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  double v = 0,5;\n  return v > 1;\n  return 0;\n}\n",
    ),
    case("`[ ]` after the type", "mine.c", "#include \"eyebot.h\"\nint main(void)\n{\n  int[4] d;\n  return 0;\n}\n"),
    case(
        "a name with a `-`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int left-speed = 1;\n  return 0;\n}\n",
    ),
    case("`include` without `#`", "mine.c", "include \"eyebot.h\"\nint main(void)\n{\n  return 0;\n}\n"),
    case("`include` without `#`", "mine.cpp", "include \"eyebot.h\"\nint main(void)\n{\n  return 0;\n}\n"),
    case(
        "`std::` and its header forgotten",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  cout << 1;\n  return 0;\n}\n",
    ),
    case(
        "a text in a `string`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  string name = \"S4\";\n  return name == 0;\n  return 0;\n}\n",
    ),
    case(
        "a pointer without a variable",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int *x, *y, *phi;\n  VWGetPosition(x, y, phi);\n  return 0;\n}\n",
    ),
    case(
        "a `#define` with `=`",
        "mine.c",
        "#include \"eyebot.h\"\n#define SPEED = 100\nint main(void)\n{\n  VWSetSpeed(SPEED, 0);\n  return 0;\n}\n",
    ),
    case(
        "`and` in place of `&&`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int a = PSDGet(1);\n  if (a > 100 and a < 200) VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case(
        "`<>` in place of `!=`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  if (PSDGet(1) <> 3) VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case(
        "`<>` in place of `!=`",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  if (PSDGet(1) <> 3) VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case(
        "`elseif`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int key = KEYRead();\n  if (key == KEY1) VWSetSpeed(0, 0);\n  elseif (key == KEY2) VWSetSpeed(100, 0);\n  return 0;\n}\n",
    ),
    case(
        "`elseif`",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int key = KEYRead();\n  if (key == KEY1) VWSetSpeed(0, 0);\n  elseif (key == KEY2) VWSetSpeed(100, 0);\n  return 0;\n}\n",
    ),
    case(
        "a word with a capital",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  If (KEYRead()) OSWait(1);\n  return 0;\n}\n",
    ),
    case(
        "a word with a capital",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  If (KEYRead()) OSWait(1);\n  return 0;\n}\n",
    ),
    case(
        "a quote missing at the beginning",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  LCDPrintf(hello\\n\");\n  return 0;\n}\n",
    ),
    case(
        "a quote missing at the beginning",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  LCDPrintf(hello\\n\");\n  return 0;\n}\n",
    ),
    case(
        "a text without quotes",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  LCDPrintf(hello world);\n  return 0;\n}\n",
    ),
    case(
        "a text without quotes",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  LCDPrintf(hello world);\n  return 0;\n}\n",
    ),
    case(
        "a number in place of a text",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d = PSDGet(1);\n  LCDPrintf(d);\n  return 0;\n}\n",
    ),
    case(
        "a number in place of a text",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d = PSDGet(1);\n  LCDPrintf(d);\n  return 0;\n}\n",
    ),
    case(
        "a text and a number joined by `+`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d = PSDGet(1);\n  LCDPrintf(\"distance \" + d);\n  return 0;\n}\n",
    ),
    case(
        "a text and a number joined by `+`",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d = PSDGet(1);\n  LCDPrintf(\"distance \" + d);\n  return 0;\n}\n",
    ),
    case("a text and a number joined by `+`", "mine.py", "from eye import *\nLCDPrintf(\"distance \" + PSDGet(1))\n"),
    case(
        "a text in a `char`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  char c = \"a\";\n  LCDPrintf(\"%c\\n\", c);\n  return 0;\n}\n",
    ),
    case(
        "a text in a `char`",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  char c = \"a\";\n  LCDPrintf(\"%c\\n\", c);\n  return 0;\n}\n",
    ),
    case(
        "a name of two words",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int my speed = 300;\n  VWSetSpeed(my speed, 0);\n  return 0;\n}\n",
    ),
    case(
        "a name of two words",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int my speed = 300;\n  VWSetSpeed(my speed, 0);\n  return 0;\n}\n",
    ),
    case(
        "a function of two words",
        "mine.c",
        "#include \"eyebot.h\"\nvoid drive_home(void) { VWStraight(100, 100); }\nint main(void)\n{\n  drive home();\n  return 0;\n}\n",
    ),
    case(
        "a function of two words",
        "mine.cpp",
        "#include \"eyebot.h\"\nvoid drive_home(void) { VWStraight(100, 100); }\nint main(void)\n{\n  drive home();\n  return 0;\n}\n",
    ),
    case(
        "an own function misspelt",
        "mine.c",
        "#include \"eyebot.h\"\nvoid driveHome(void) { VWStraight(100, 100); }\nint main(void)\n{\n  driveHom();\n  return 0;\n}\n",
    ),
    case(
        "an own function misspelt",
        "mine.cpp",
        "#include \"eyebot.h\"\nvoid driveHome(void) { VWStraight(100, 100); }\nint main(void)\n{\n  driveHom();\n  return 0;\n}\n",
    ),
    case(
        "a function that is not called",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(100, 100);\n  VWWait;\n  return 0;\n}\n",
    ),
    case(
        "a function that is not called",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(100, 100);\n  VWWait;\n  return 0;\n}\n",
    ),
    case(
        "a type within a call",
        "mine.c",
        "#include \"eyebot.h\"\nvoid drive(int mm) { VWStraight(mm, 100); }\nint main(void)\n{\n  drive(int 300);\n  return 0;\n}\n",
    ),
    case(
        "a type within a call",
        "mine.cpp",
        "#include \"eyebot.h\"\nvoid drive(int mm) { VWStraight(mm, 100); }\nint main(void)\n{\n  drive(int 300);\n  return 0;\n}\n",
    ),
    case(
        "a type in front of a call",
        "mine.c",
        "#include \"eyebot.h\"\nvoid drive(int mm) { VWStraight(mm, 100); }\nint main(void)\n{\n  void drive(300);\n  return 0;\n}\n",
    ),
    case(
        "a type in front of a call",
        "mine.cpp",
        "#include \"eyebot.h\"\nvoid drive(int mm) { VWStraight(mm, 100); }\nint main(void)\n{\n  void drive(300);\n  return 0;\n}\n",
    ),
    case(
        "an array set to a list",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d[3];\n  d = {1, 2, 3};\n  LCDPrintf(\"%d\\n\", d[0]);\n  return 0;\n}\n",
    ),
    case(
        "an array set to a list",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d[3];\n  d = {1, 2, 3};\n  LCDPrintf(\"%d\\n\", d[0]);\n  return 0;\n}\n",
    ),
    case(
        "the address of a local array",
        "mine.c",
        "#include \"eyebot.h\"\nint *distances(void)\n{\n  int d[4];\n  d[0] = PSDGet(1);\n  return d;\n}\nint main(void)\n{\n  LCDPrintf(\"%d\\n\", distances()[0]);\n  return 0;\n}\n",
    ),
    case(
        "the address of a local array",
        "mine.cpp",
        "#include \"eyebot.h\"\nint *distances(void)\n{\n  int d[4];\n  d[0] = PSDGet(1);\n  return d;\n}\nint main(void)\n{\n  LCDPrintf(\"%d\\n\", distances()[0]);\n  return 0;\n}\n",
    ),
    case(
        "an `else` with a condition",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int key = KEYRead();\n  if (key == KEY1)\n    VWSetSpeed(0, 0);\n  else (key == KEY2)\n    VWSetSpeed(100, 0);\n  return 0;\n}\n",
    ),
    case(
        "an `else` with a condition",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int key = KEYRead();\n  if (key == KEY1)\n    VWSetSpeed(0, 0);\n  else (key == KEY2)\n    VWSetSpeed(100, 0);\n  return 0;\n}\n",
    ),
    case(
        "`:` in place of `{`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  if (KEYRead() == KEY1):\n    VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case(
        "`:` in place of `{`",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  if (KEYRead() == KEY1):\n    VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case("`:` in place of `;`", "mine.c", "#include \"eyebot.h\"\nint main(void)\n{\n  LCDClear():\n  return 0;\n}\n"),
    case(
        "`:` in place of `;`",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  LCDClear():\n  return 0;\n}\n",
    ),
    case(
        "a `;` after `while (...)`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d = PSDGet(1);\n  while (d > 200) ;\n    d = PSDGet(1);\n  return 0;\n}\n",
    ),
    case(
        "a `;` after `while (...)`",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d = PSDGet(1);\n  while (d > 200) ;\n    d = PSDGet(1);\n  return 0;\n}\n",
    ),
    case(
        "a chained comparison",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d = PSDGet(1);\n  if (100 < d < 200)\n    VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case(
        "a chained comparison",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int d = PSDGet(1);\n  if (100 < d < 200)\n    VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case(
        "a statement outside of `main`",
        "mine.c",
        "#include \"eyebot.h\"\nLCDPrintf(\"hello\\n\");\nint main(void)\n{\n  return 0;\n}\n",
    ),
    case(
        "a statement outside of `main`",
        "mine.cpp",
        "#include \"eyebot.h\"\nLCDPrintf(\"hello\\n\");\nint main(void)\n{\n  return 0;\n}\n",
    ),
    case("a `{` missing", "mine.c", "#include \"eyebot.h\"\nint main(void)\n  VWStraight(100, 100);\n  return 0;\n}\n"),
    case(
        "a `{` missing",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n  VWStraight(100, 100);\n  return 0;\n}\n",
    ),
    case(
        "a number that begins with 0",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWTurn(090, 90);\n  return 0;\n}\n",
    ),
    case(
        "a number that begins with 0",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWTurn(090, 90);\n  return 0;\n}\n",
    ),
    case("`**` for a power", "mine.c", "#include \"eyebot.h\"\nint main(void)\n{\n  return 2 ** 3;\n  return 0;\n}\n"),
    case(
        "`**` for a power",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  return 2 ** 3;\n  return 0;\n}\n",
    ),
    case(
        "`%` of a `double`",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  double d = PSDGet(1);\n  if (d % 2 == 0) VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case(
        "`%` of a `double`",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  double d = PSDGet(1);\n  if (d % 2 == 0) VWSetSpeed(0, 0);\n  return 0;\n}\n",
    ),
    case("`void main`", "mine.cpp", "#include \"eyebot.h\"\nvoid main()\n{\n  VWStraight(100, 100);\n}\n"),
    case(
        "`cout >>`",
        "mine.cpp",
        "#include \"eyebot.h\"\n#include <iostream>\nint main(void)\n{\n  std::cout >> 1;\n  return 0;\n}\n",
    ),
    case(
        "`.` after a pointer",
        "mine.cpp",
        "#include \"eyebot.h\"\nstruct Robo { void go() { VWWait(); } };\nint main(void)\n{\n  Robo *r = new Robo;\n  r.go();\n  return 0;\n}\n",
    ),
    case(
        "an index outside of a `vector`",
        "mine.cpp",
        "#include \"eyebot.h\"\n#include <vector>\nint main(void)\n{\n  std::vector<int> d(4);\n  d[VWWait() + 4] = 1;\n  return 0;\n}\n",
    ),
    case(
        "an index outside of a `vector`",
        "mine.cpp",
        "#include \"eyebot.h\"\n#include <vector>\nint main(void)\n{\n  std::vector<int> d(4);\n  d[VWWait() - 1] = 1;\n  return 0;\n}\n",
    ),
    case(
        "memory of `new` overrun",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int *map = new int[4];\n  for (int i = 0; i <= 400; i++)\n    map[i] = PSDGet(1);\n  delete[] map;\n  return 0;\n}\n",
    ),
    case("no `main`", "mine.c", "#include \"eyebot.h\"\nint drive(void)\n{\n  return VWStraight(100, 100);\n}\n"),
    case("no `main`", "mine.cpp", "#include \"eyebot.h\"\nint drive(void)\n{\n  return VWStraight(100, 100);\n}\n"),
    case("a loop without an end", "mine.c", "int main(void)\n{\n  while (1)\n    ;\n}\n"),
    case("a loop without an end", "mine.cpp", "int main()\n{\n  while (true)\n    ;\n}\n"),
    case("a loop without an end", "mine.py", "while True:\n    pass\n"),
    case("a loop without an end", "mine", "let mut n = 0_u64; while std::hint::black_box(n) < u64::MAX { n += 1; }"),
    case(
        "division by a variable that is 0",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int parts = LCDClear();\n  LCDPrintf(\"%d\\n\", 100 / parts);\n  return 0;\n}\n",
    ),
    case(
        "division by a variable that is 0",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  int parts = LCDClear();\n  LCDPrintf(\"%d\\n\", 100 / parts);\n}\n",
    ),
    case("division by a variable that is 0", "mine.py", "from eye import *\nparts = LCDClear()\nprint(100 // parts)\n"),
    case(
        "division by a variable that is 0",
        "mine",
        "let parts = std::env::args().count() - std::env::args().count();\n    println!(\"{}\", 100 / parts);",
    ),
    case(
        "division by a number that is 0",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int parts = 0;\n  LCDPrintf(\"%d\\n\", 100 / parts);\n  return 0;\n}\n",
    ),
    case(
        "division by a number that is 0",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  LCDPrintf(\"%d\\n\", 100 / 0);\n}\n",
    ),
    case("division by a number that is 0", "mine.py", "print(100 // 0)\n"),
    case("division by a number that is 0", "mine", "println!(\"{}\", 100 / 0);"),
    case(
        "a text too long for its array",
        "mine.c",
        "#include <stdio.h>\n#include <string.h>\nint main(int argc, char **argv)\n{\n  char name[4];\n  strcpy(name, argv[0]);\n  strcat(name, \"a name that is too long\");\n  puts(name);\n  return 0;\n}\n",
    ),
    case(
        "a text too long for its array",
        "mine.cpp",
        "#include <cstdio>\nint main()\n{\n  char name[4];\n  std::sprintf(name, \"a name that is too long\");\n  std::puts(name);\n}\n",
    ),
    case(
        "an index beyond the array",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int distances[4];\n  for (int i = 0; i <= 40; i++)\n    distances[i] = PSDGet(1);\n  return distances[0];\n}\n",
    ),
    case(
        "an index beyond the array",
        "mine.cpp",
        "#include <cstdio>\n#include <vector>\nint main()\n{\n  std::vector<int> distances(4);\n  std::printf(\"%d\\n\", distances.at(4));\n}\n",
    ),
    case("an index beyond the array", "mine.py", "distances = [0] * 4\ndistances[4] = 1\n"),
    case(
        "an index beyond the array",
        "mine",
        "let distances = vec![0; 4];\n    let last = distances.len();\n    println!(\"{}\", distances[last]);",
    ),
    case(
        "an index beyond memory of `malloc`",
        "mine.c",
        "#include <stdio.h>\n#include <stdlib.h>\nint main(void)\n{\n  int *map = malloc(4 * sizeof(int));\n  for (int i = 0; i <= 400; i++)\n    map[i] = i;\n  printf(\"%d\\n\", map[3]);\n  free(map);\n  return 0;\n}\n",
    ),
    case(
        "an index just beyond memory of `malloc`",
        "mine.c",
        "#include <stdio.h>\n#include <stdlib.h>\nint main(void)\n{\n  int *map = malloc(4 * sizeof(int));\n  for (int i = 0; i <= 4; i++)\n    map[i] = i;\n  printf(\"%d\\n\", map[3]);\n  free(map);\n  return 0;\n}\n",
    ),
    case(
        "freed twice",
        "mine.c",
        "#include <stdio.h>\n#include <stdlib.h>\nint main(void)\n{\n  char *map = malloc(100);\n  sprintf(map, \"a map\");\n  puts(map);\n  free(map);\n  free(map);\n  return 0;\n}\n",
    ),
    case(
        "nothing to read",
        "mine.c",
        "#include <stdio.h>\nint main(void)\n{\n  int n = -1;\n  scanf(\"%d\", &n);\n  printf(\"read %d\\n\", n);\n  return 0;\n}\n",
    ),
    case(
        "nothing to read",
        "mine.cpp",
        "#include <iostream>\nint main()\n{\n  int n = -1;\n  std::cin >> n;\n  std::cout << n;\n}\n",
    ),
    case("nothing to read", "mine.py", "n = int(input())\n"),
    case(
        "nothing to read",
        "mine",
        "let mut line = String::new();\n    std::io::stdin().read_line(&mut line).unwrap();\n    println!(\"{}\", line.trim().parse::<i32>().unwrap());",
    ),
    case(
        "a file that does not exist",
        "mine.c",
        "#include <stdio.h>\nint main(void)\n{\n  char line[80];\n  FILE *map = fopen(\"map.txt\", \"r\");\n  fgets(line, 80, map);\n  return 0;\n}\n",
    ),
    case(
        "a file that does not exist",
        "mine.cpp",
        "#include <fstream>\n#include <iostream>\n#include <string>\nint main()\n{\n  std::ifstream map(\"map.txt\");\n  std::string line;\n  std::getline(map, line);\n  std::cout << line.at(0) << '\\n';\n}\n",
    ),
    case("a file that does not exist", "mine.py", "print(open(\"map.txt\").read())\n"),
    case("a file that does not exist", "mine", "println!(\"{}\", std::fs::read_to_string(\"map.txt\").unwrap());"),
    case("a path of Windows", "mine.py", "print(open(\"..\\\\maps\\\\map.txt\").read())\n"),
    case("a path with a drive", "mine.py", "print(open(r\"C:\\maps\\map.txt\").read())\n"),
    case("a path with `\\U`", "mine.py", "print(open(\"C:\\Users\\me\\map.txt\").read())\n"),
    case(
        "a file of a program that goes on",
        "mine.cpp",
        "#include <fstream>\n#include <iostream>\n#include <string>\nint main()\n{\n  std::string line;\n  std::ifstream map(\"map.txt\");\n  while (std::getline(map, line))\n    std::cout << line << '\\n';\n}\n",
    ),
    case(
        "a sensor that the robot does not have",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  LCDPrintf(\"%d\\n\", PSDGet(9));\n  return 0;\n}\n",
    ),
    case(
        "a sensor that the robot does not have",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  LCDPrintf(\"%d\\n\", PSDGet(9));\n}\n",
    ),
    case("a sensor that the robot does not have", "mine.py", "from eye import *\nPSDGet(9)\n"),
    case("a sensor that the robot does not have", "mine", "robot.psd(PsdAt::FrontLeft)?;"),
    Case {
        mistake: "a type of robot that does not exist",
        program: "mine.c",
        text: "int main(void) { return 0; }\n",
        robot: Some("S5 500 500 0 mine.c"),
    },
    Case {
        mistake: "a name with a blank",
        program: "my robot.c",
        text: "int main(void) { return 0; }\n",
        robot: Some("S4 500 500 0 my robot.c"),
    },
    Case {
        mistake: "the case of a name",
        program: "mine.c",
        text: "int main(void) { return 0; }\n",
        robot: Some("S4 500 500 0 Mine.c"),
    },
    Case {
        mistake: "the file does not exist",
        program: "mine.c",
        text: "int main(void) { return 0; }\n",
        robot: Some("S4 500 500 0 min.c"),
    },
    case(
        "a drive without a wait",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWTurn(90, 90);\n  VWStraight(100, 100);\n  return 0;\n}\n",
    ),
    case(
        "a drive without a wait",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  VWTurn(90, 90);\n  VWStraight(100, 100);\n}\n",
    ),
    case("a drive without a wait", "mine.py", "from eye import *\nVWTurn(90, 90)\nVWStraight(100, 100)\n"),
    case(
        "0.3 truncated to 0",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(1000, 0.3);\n  return 0;\n}\n",
    ),
    case("0.3 truncated to 0", "mine.cpp", "#include \"eyebot.h\"\nint main()\n{\n  VWStraight(1000, 0.3);\n}\n"),
    case("0.3 truncated to 0", "mine.py", "from eye import *\nVWStraight(1000, 0.3)\n"),
    case("half a second", "mine.c", "#include \"eyebot.h\"\nint main(void)\n{\n  OSWait(0.5);\n  return 0;\n}\n"),
    case("half a second", "mine.cpp", "#include \"eyebot.h\"\nint main()\n{\n  OSWait(0.5);\n}\n"),
    case("half a second", "mine.py", "from eye import *\nOSWait(0.5)\n"),
    case(
        "a drive of no length",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(1000 * (1 / 2), 300);\n  return VWWait();\n}\n",
    ),
    case(
        "a drive of no length",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  VWStraight(1000 * (1 / 2), 300);\n  VWWait();\n}\n",
    ),
    case("a drive of no length", "mine.py", "from eye import *\nVWStraight(1000 * (1 // 2), 300)\nVWWait()\n"),
    case(
        "a drive of no length with RoBIOS 6",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWHandle vw = VWInit(VW_DRIVE, 1);\n  VWDriveStraight(vw, 1 / 2, 0.3);\n  return VWDriveWait(vw);\n}\n",
    ),
    case(
        "a speed that is not a number",
        "mine.c",
        "#include <math.h>\n#include \"eyebot.h\"\nint main(void)\n{\n  double left = LCDClear() - 1;\n  VWSetSpeed(100 * sqrt(left), 0);\n  OSWait(100);\n  return 0;\n}\n",
    ),
    case(
        "a speed that is not a number",
        "mine.cpp",
        "#include <cmath>\n#include \"eyebot.h\"\nint main()\n{\n  double left = LCDClear() - 1;\n  VWSetSpeed(100 * std::sqrt(left), 0);\n  OSWait(100);\n}\n",
    ),
    case("a speed that is not a number", "mine.py", "from eye import *\nVWSetSpeed(float(\"nan\"), 0)\n"),
    case(
        "functions of both generations",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWHandle vw = VWInit(VW_DRIVE, 1);\n  VWStraight(100, 100);\n  return 0;\n}\n",
    ),
    case(
        "functions of both generations",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  VWHandle vw = VWInit(VW_DRIVE, 1);\n  VWStraight(100, 100);\n}\n",
    ),
    case(
        "functions of both generations",
        "mine.py",
        "from eye import *\nvw = VWInit(VW_DRIVE, 1)\nVWStraight(100, 100)\n",
    ),
    case(
        "a function that calls itself for ever",
        "mine.c",
        "int deep(int n)\n{\n  return deep(n + 1) + n;\n}\n\nint main(void)\n{\n  return deep(0);\n}\n",
    ),
    case(
        "a function that calls itself for ever",
        "mine.cpp",
        "struct Maze {\n  int deep(int n) { return deep(n + 1) + n; }\n};\n\nint main()\n{\n  return Maze().deep(0);\n}\n",
    ),
    case("a function that calls itself for ever", "mine.py", "def deep(n):\n    return deep(n + 1) + n\n\n\ndeep(0)\n"),
    case(
        "a function that calls itself for ever",
        "mine",
        "fn deep(n: u64) -> u64 {\n        std::hint::black_box(deep(n + 1)) + n\n    }\n    println!(\"{}\", deep(0));",
    ),
    case(
        "a variable without a value",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int speed;\n  return VWSetSpeed(speed, 0);\n}\n",
    ),
    case(
        "a variable without a value",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  int speed;\n  VWSetSpeed(speed, 0);\n}\n",
    ),
    case(
        "a step beyond the end of a linked list",
        "mine.c",
        "#include <stdio.h>\nstruct wall { int mm; struct wall *next; };\nint main(void)\n{\n  struct wall first = {300, NULL};\n  struct wall *wall = &first;\n  printf(\"%d\\n\", wall->next->mm);\n  return 0;\n}\n",
    ),
    case(
        "a step beyond the end of a linked list",
        "mine.cpp",
        "#include <iostream>\nstruct Wall { int mm = 300; Wall *next = nullptr; };\nint main()\n{\n  Wall first;\n  Wall *wall = &first;\n  std::cout << wall->next->mm << std::endl;\n}\n",
    ),
    case(
        "a step beyond the end of a linked list",
        "mine.py",
        "class Wall:\n    next = None\n    mm = 300\nprint(Wall().next.mm)\n",
    ),
    case(
        "a speed of the other generation",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  VWHandle vw = VWInit(VW_DRIVE, 1);\n  VWSetSpeed(vw, 100, 0);\n  VWWait();\n  return \
         0;\n}\n",
    ),
    case("a variable without a value", "mine.py", "from eye import *\nVWSetSpeed(speed, 0)\n"),
    case("a variable without a value", "mine", "let speed: i32;\n    println!(\"{speed}\");"),
    case(
        "lines from Windows",
        "mine.c",
        "#include <stdio.h>\r\nint main(void)\r\n{\r\n  printf(\"runs\\n\");\r\n  return 0;\r\n}\r\n",
    ),
    case("lines from Windows", "mine.py", "print(\"runs\")\r\n"),
    case(
        "letters of Latin-1",
        "mine.c",
        "#include <stdio.h>\nint main(void)\n{\n  printf(\"gr\u{F6}\u{DF}er\\n\");\n  return 0;\n}\n",
    ),
    case("letters of Latin-1", "mine.py", "print(\"gr\u{F6}\u{DF}er\")\n"),
    case("letters of Latin-1", "mine", "println!(\"gr\u{F6}\u{DF}er\");"),
    case(
        "text without an end of line",
        "mine.c",
        "#include <stdio.h>\nint main(void)\n{\n  printf(\"shown\");\n  return 0;\n}\n",
    ),
    case("text without an end of line", "mine.py", "print(\"shown\", end=\"\")\n"),
    case(
        "text without an end of line before a break",
        "mine.c",
        "#include <stdio.h>\nint main(void)\n{\n  int *place = NULL;\n  printf(\"at the start\");\n  printf(\", in %d\", *place);\n  return 0;\n}\n",
    ),
    case(
        "text without an end of line before a break",
        "mine.cpp",
        "#include <iostream>\nint main()\n{\n  int *place = nullptr;\n  std::cout << \"at the start\";\n  std::cout << *place;\n}\n",
    ),
    case("text without an end of line before a break", "mine.py", "print(\"at the start\", end=\"\")\nprint(1 // 0)\n"),
    case(
        "a file of the program that is not named",
        "mine.c",
        "#include \"eyebot.h\"\nint plan(int way);\nint main(void)\n{\n  return VWStraight(plan(100), 100);\n}\n",
    ),
    case(
        "a header that does not exist",
        "mine.c",
        "#include \"eyebot.h\"\n#include \"tools.h\"\nint main(void)\n{\n  return VWStraight(100, 100);\n}\n",
    ),
    case(
        "an argument that is not given",
        "mine.c",
        "#include \"eyebot.h\"\nint main(int argc, char *argv[])\n{\n  int way = atoi(argv[1]);\n  return VWStraight(way, 100);\n}\n",
    ),
    case(
        "an argument that is not given",
        "mine.cpp",
        "#include \"eyebot.h\"\n#include <string>\nint main(int argc, char *argv[])\n{\n  int way = std::stoi(argv[1]);\n  \
         VWStraight(way, 100);\n}\n",
    ),
    case(
        "an argument that is not given",
        "mine.py",
        "import sys\nfrom eye import *\nway = int(sys.argv[1])\nVWStraight(way, 100)\n",
    ),
    case(
        "a list of Python",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  int[2] ways = [100, 200];\n  return VWStraight(ways[0], 100);\n}\n",
    ),
    case(
        "a list of Python",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  int ways[2] = [100, 200];\n  VWStraight(ways[0], 100);\n}\n",
    ),
    case(
        "an index of a single value",
        "mine.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n  BYTE img;\n  CAMInit(QVGA);\n  CAMGet(&img);\n  return img[3];\n}\n",
    ),
    case(
        "an index of a single value",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  BYTE img;\n  CAMInit(QVGA);\n  CAMGet(&img);\n  return img[3];\n}\n",
    ),
    case(
        "`extern \"C\"` in C",
        "mine.c",
        "#include \"eyebot.h\"\nextern \"C\" {\nint home(void);\n}\nint main(void)\n{\n  return VWStraight(100, 100);\n}\n",
    ),
    case(
        "`<algorithm>` forgotten",
        "mine.cpp",
        "#include \"eyebot.h\"\nint main()\n{\n  int d[2] = {PSDGet(1), PSDGet(2)};\n  std::sort(d, d + 2);\n  LCDPrintf(\"%d\\n\", d[0]);\n}\n",
    ),
];

/// Name of a tool and its major version, for Python also the minor one: `gcc 12`, `Python 3.11`.
fn version(tool: &str) -> String {
    let output = Command::new(tool).arg("--version").output().expect("the tool runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let line = text.lines().next().unwrap_or_default();
    let name = if tool == "cc" && !line.contains("clang") { "gcc" } else { line.split(' ').next().unwrap_or_default() };
    let number = line.rsplit(' ').next().unwrap_or_default();
    let kept = if name == "Python" { 2 } else { 1 };
    format!("{name} {}", number.split('.').take(kept).collect::<Vec<_>>().join("."))
}

/// Writes the program for `text` into the folder of a run.
fn write(scratch: &Scratch, case: &Case) {
    let bytes = |text: &str| match case.mistake {
        // Each letter becomes the byte with the same number.
        "letters of Latin-1" => text.chars().map(|letter| u8::try_from(u32::from(letter)).expect("Latin-1")).collect(),
        _ => text.as_bytes().to_vec(),
    };
    if case.program != "mine" {
        fs::write(scratch.path().join(case.program), bytes(case.text)).expect("the program");
        if case.text.contains("plan(") {
            scratch.write(MAP.0, MAP.1);
        }
        return;
    }
    if !scratch.path().join("mine").exists() {
        let ran = scratch.eyesim(&["new", "mine", "--lang", "rust"]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
    }
    let head = "use robios_api::prelude::*;\n\nrobios_api::program!(main);\n\nfn main(robot: &Robot) -> Result {\n    let _ = robot;\n";
    let text = format!("{head}    {}\n    Ok(())\n}}\n", case.text);
    fs::write(scratch.path().join("mine/src/lib.rs"), bytes(&text)).expect("the program");
}

/// The first lines of a run's output: the message with the line that names its location, if there is one, or up to
/// three lines that begin with the program's own output.
fn first_lines(scratch: &Scratch, case: &Case) -> String {
    let robot = case.robot.map_or(format!("S4 500 500 0 {}", case.program), str::to_owned);
    scratch.write("scene.sim", &format!("world %sim%/worlds/empty.wld\n{robot}\n"));
    write(scratch, case);
    // Both streams go into one pipe, like on a terminal.
    let line = format!("'{}' run scene.sim --timeout 0.5 2>&1", eyesim_path().display());
    let output = Command::new("sh").args(["-c", &line]).current_dir(scratch.path()).output().expect("sh runs");
    let folder = scratch.path().display().to_string();
    let printed = String::from_utf8_lossy(&output.stdout).replace(&folder, "FOLDER");
    // Skips the note on the generation, the head and the robot's row of the table, and the upper part of a traceback.
    let is_message = |line: &&str| {
        let note = [": RoBIOS-7 (", ": RoBIOS 6 ("].iter().any(|note| line.contains(note))
            || line.contains(", as the sim file is; ");
        let table = line.trim().is_empty() || line.starts_with("robot ") || line.starts_with("r1 S4");
        let traceback = line.contains("s] Traceback")
            || line.contains(" s]     ")
            || line.contains(" s]   [Previous line")
            || line.contains(": In function");
        !note && !table && !traceback
    };
    let lines: Vec<&str> = printed.lines().filter(is_message).collect();
    // Python prints the locations before the message, the innermost location last.
    let is_place = |line: &&&str| line.contains(" s]   File ");
    if let Some(message) = lines.iter().position(|line| !is_place(&line)).filter(|index| *index > 0) {
        return lines[message - 1..=message].join("\n");
    }
    let first = lines.first().copied().unwrap_or_default();
    // The program's end follows its output or a hint.
    if first.starts_with("[r1 ") {
        let lines: Vec<&str> = lines
            .iter()
            .copied()
            .take_while(|line| !line.starts_with("simulated ") && !line.starts_with("r1 ("))
            .take(3)
            .collect();
        return lines.join("\n");
    }
    // The compiler's first message follows the line that names the program.
    let is_error = |line: &&&str| {
        let words = ["error: ", "error[", "did you mean", "--> "];
        words.iter().any(|word| line.contains(word)) && !line.starts_with("collect2")
    };
    let index =
        lines.iter().find(|line| line.trim_start().starts_with("--> ")).filter(|_| first.starts_with("warning: "));
    let more = if let Some(index) = index {
        vec![*index]
    } else if ["not compile", "not link", "not build"].iter().any(|word| first.contains(word)) {
        lines[1..].iter().filter(is_error).take(if case.program == "mine" { 2 } else { 1 }).copied().collect()
    } else {
        Vec::new()
    };
    [vec![first], more].concat().join("\n")
}

/// The first lines of all cases. Programs in Rust share a folder, since a new one compiles the API again; the others
/// run beside them.
fn lines_of_all() -> Vec<String> {
    let rust = Scratch::new();
    let run = |is_rust: bool| {
        let cases = CASES.iter().enumerate().filter(move |(_, case)| (case.program == "mine") == is_rust);
        let lines = |case| if is_rust { first_lines(&rust, case) } else { first_lines(&Scratch::new(), case) };
        cases.map(|(index, case)| (index, lines(case))).collect()
    };
    let (mut lines, others): (Vec<_>, Vec<_>) = thread::scope(|scope| {
        let others = scope.spawn(|| run(false));
        (run(true), others.join().expect("no panic"))
    });
    lines.extend(others);
    lines.sort();
    lines.into_iter().map(|(_, lines)| lines).collect()
}

#[test]
fn the_page_shows_what_beginners_see() {
    let tools = format!("{} and {}", version("cc"), version("python3"));
    let mut page = format!(
        "# Mistakes of beginners\n\nFirst lines that `eyesim run` shows after a usual mistake, in each language where it can be made, with \
         {tools}.\n`tests/tests/black_box/mistakes.rs` has the programs and compares; `INSTA_UPDATE=always` renews this page. `FOLDER` stands for \
         the\nfolder of the scene.\n"
    );
    let mut last = "";
    for (case, lines) in CASES.iter().zip(lines_of_all()) {
        if case.mistake != last {
            write!(page, "\n## {}{}\n", case.mistake[..1].to_uppercase(), &case.mistake[1..]).expect("a string");
            last = case.mistake;
        }
        let language = match case.program {
            "mine" => "Rust",
            program if program.ends_with(".cpp") => "C++",
            program if program.ends_with(".py") => "Python",
            _ => "C",
        };
        assert!(!lines.is_empty(), "{} in {language} says nothing", case.mistake);
        write!(page, "\n{language}:\n\n```text\n{lines}\n```\n").expect("a string");
    }
    let path = root().join("docs/mistakes.md");
    if std::env::var("INSTA_UPDATE").is_ok_and(|value| value == "always") {
        fs::write(&path, &page).expect("the page is writable");
    }
    let committed = fs::read_to_string(path).expect("the page");
    if !committed.contains(&tools) {
        println!("not compared: the page was made with other tools than {tools}");
        return;
    }
    for (number, (expected, found)) in (1..).zip(committed.lines().zip(page.lines())) {
        assert_eq!(expected, found, "docs/mistakes.md:{number}; INSTA_UPDATE=always renews the page");
    }
    assert_eq!(committed.lines().count(), page.lines().count(), "INSTA_UPDATE=always renews docs/mistakes.md");
}
