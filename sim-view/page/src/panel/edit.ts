// Places, adds and removes robots and objects.

import { element } from "../dom";
import type { Model, Selection } from "../model";
import type { Pose } from "../protocol";
import { button, choice, labelled, numberField, numberOf, section, setOptions, setReason, setValue, whileOpen } from "./control";
import { act, onRights, whyNot } from "./notice";

const STEP_MM = 50;
const STEP_DEG = 15;
const DEGREE = Math.PI / 180;

export function editPanel(model: Model): HTMLElement {
  const which = choice("edit-which", "Robot or object", () => model.select(selectionOf(which.value)));
  const [x, y, heading] = [numberField("edit-x"), numberField("edit-y"), numberField("edit-heading")];
  const put = element("button", { type: "submit", textContent: "Put there", testid: "edit-place" });
  const form = element("form", { className: "row" }, [labelled("x in mm", x), labelled("y in mm", y), labelled("heading in °", heading), put]);
  const move = (dx_mm: number, dy_mm: number, turn_deg: number) => () => nudge(dx_mm, dy_mm, turn_deg);
  const steps = [
    named(button("←", "edit-left", move(-STEP_MM, 0, 0)), `${STEP_MM} mm to the left (against x)`),
    named(button("↑", "edit-up", move(0, STEP_MM, 0)), `${STEP_MM} mm upwards (along y)`),
    named(button("↓", "edit-down", move(0, -STEP_MM, 0)), `${STEP_MM} mm downwards (against y)`),
    named(button("→", "edit-right", move(STEP_MM, 0, 0)), `${STEP_MM} mm to the right (along x)`),
    named(button("↺", "edit-turn-left", move(0, 0, STEP_DEG)), `${STEP_DEG}° to the left`),
    named(button("↻", "edit-turn-right", move(0, 0, -STEP_DEG)), `${STEP_DEG}° to the right`),
  ];
  const remove = button("Remove", "edit-remove", () => void removeSelected());

  const kind = choice("add-kind", "What to add", showProgram);
  const program = choice("add-program", "Its program", () => undefined);
  const withProgram = labelled("Program", program);
  const [addX, addY, addHeading] = [numberField("add-x"), numberField("add-y"), numberField("add-heading", { value: "0" })];
  const add = element("button", { type: "submit", textContent: "Add", testid: "add" });
  const adding = element("form", {}, [
    element("div", { className: "row" }, [labelled("Add", kind), withProgram]),
    element("div", { className: "row" }, [labelled("x in mm", addX), labelled("y in mm", addY), labelled("heading in °", addHeading), add]),
  ]);
  const nothing = element("p", { className: "muted", textContent: "This scene knows nothing that could be added." });
  const panel = section("Edit", "edit-panel", false, [labelled("Robot or object", which), form, element("div", { className: "row" }, [...steps, remove]), element("hr"), adding, nothing]);

  form.onsubmit = (event) => {
    event.preventDefault();
    const [x_mm, y_mm, turn_deg] = [numberOf(x), numberOf(y), numberOf(heading)];
    if (x_mm !== undefined && y_mm !== undefined && turn_deg !== undefined)
      void putAt({ x_m: x_mm / 1000, y_m: y_mm / 1000, phi_rad: turn_deg * DEGREE });
  };
  adding.onsubmit = (event) => {
    event.preventDefault();
    void addOne();
  };
  const scheduleDraw = whileOpen(panel, draw, 200);
  for (const topic of ["scene", "snapshot", "selected"] as const) model.subscribe(topic, scheduleDraw);
  model.subscribe("selected", fillPlace);
  onRights(model, allow);
  return panel;

  function draw(): void {
    const { robots = [], objects = [], addable_types } = model.scene ?? {};
    const bodies: [string, string][] = [
      ...robots.map(({ id, name }): [string, string] => [`robot ${id}`, `robot ${id} ${name}`]),
      ...objects.map(({ id, kind }): [string, string] => [`object ${id}`, `object ${id} ${kind}`]),
    ];
    setOptions(which, [["", "none"], ...bodies]);
    which.value = nameOf(model.selected);
    const kinds: [string, string][] = [
      ...(addable_types?.robots ?? []).map((name): [string, string] => [`robot ${name}`, `robot ${name}`]),
      ...(addable_types?.objects ?? []).map((name): [string, string] => [`object ${name}`, `object ${name}`]),
    ];
    setOptions(kind, kinds);
    adding.hidden = kinds.length === 0;
    nothing.hidden = kinds.length > 0;
    const programs = robots.filter((robot) => robot.program !== "");
    setOptions(program, [["", "none"], ...programs.map(({ id, name, program }): [string, string] => [String(id), `${program} as ${name}`])]);
    showProgram();
    if (!form.contains(document.activeElement)) fillPlace();
    if (addX.value === "" && model.scene) fillMiddle(model.scene.bounds_m);
    allow();
  }

  function showProgram(): void {
    withProgram.hidden = !kind.value.startsWith("robot ");
  }

  function fillMiddle([[left, bottom], [right, top]]: [[number, number], [number, number]]): void {
    addX.value = String(Math.round((left + right) * 500));
    addY.value = String(Math.round((bottom + top) * 500));
  }

  function fillPlace(): void {
    const pose = poseOf(model, model.selected);
    setValue(x, pose ? (pose.x_m * 1000).toFixed(0) : "");
    setValue(y, pose ? (pose.y_m * 1000).toFixed(0) : "");
    setValue(heading, pose ? (withoutTurns(pose.phi_rad) / DEGREE).toFixed(1) : "");
  }

  async function putAt({ x_m, y_m, phi_rad }: Pose): Promise<void> {
    const { selected } = model;
    if (!selected) return;
    if ("robot" in selected) await act(model, { do: "place_robot", robot: selected.robot, x_m, y_m, phi_rad });
    else await act(model, { do: "place_object", object: selected.object, x_m, y_m, phi_rad });
  }

  function nudge(dx_mm: number, dy_mm: number, turn_deg: number): void {
    const pose = poseOf(model, model.selected);
    if (pose) void putAt({ x_m: pose.x_m + dx_mm / 1000, y_m: pose.y_m + dy_mm / 1000, phi_rad: pose.phi_rad + turn_deg * DEGREE });
  }

  function removeSelected(): Promise<boolean> | undefined {
    const { selected } = model;
    if (!selected) return undefined;
    return act(model, "robot" in selected ? { do: "remove_robot", robot: selected.robot } : { do: "remove_object", object: selected.object });
  }

  async function addOne(): Promise<void> {
    const [x_mm, y_mm, turn_deg] = [numberOf(addX), numberOf(addY), numberOf(addHeading)];
    if (x_mm === undefined || y_mm === undefined || turn_deg === undefined) return;
    const pose = { x_m: x_mm / 1000, y_m: y_mm / 1000, phi_rad: turn_deg * DEGREE };
    const isRobot = kind.value.startsWith("robot ");
    const name = kind.value.slice(kind.value.indexOf(" ") + 1);
    const program_of = program.value === "" ? null : Number(program.value);
    selectNext(isRobot);
    await act(model, isRobot ? { do: "add_robot", kind: name, program_of, ...pose } : { do: "add_object", kind: name, ...pose });
  }

  /** Selects the next robot or object that the scene gets, so that it can be dragged at once. */
  function selectNext(isRobot: boolean): void {
    const ids = () => (isRobot ? model.scene?.robots : model.scene?.objects)?.map(({ id }) => id) ?? [];
    const before = new Set(ids());
    const stop = model.subscribe("scene", () => {
      const added = ids().find((id) => !before.has(id));
      if (added === undefined) return;
      setTimeout(() => stop());
      model.select(isRobot ? { robot: added } : { object: added });
    });
    setTimeout(() => stop(), 3000);
  }

  function allow(): void {
    const why = whyNot(model);
    setReason([x, y, heading, put, remove, ...steps], why || (model.selected ? "" : "Choose a robot or an object first"));
    setReason([kind, program, addX, addY, addHeading, add], why);
  }
}

function withoutTurns(angle: number): number {
  return angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
}

function named(made: HTMLButtonElement, name: string): HTMLButtonElement {
  made.ariaLabel = made.title = name;
  return made;
}

function nameOf(selected: Selection | null): string {
  if (!selected) return "";
  return "robot" in selected ? `robot ${selected.robot}` : `object ${selected.object}`;
}

function selectionOf(name: string): Selection | null {
  const [what, number] = name.split(" ");
  if (!number) return null;
  return what === "robot" ? { robot: Number(number) } : { object: Number(number) };
}

function poseOf(model: Model, selected: Selection | null): Pose | undefined {
  if (!selected) return undefined;
  if ("object" in selected) return model.snapshot?.objects.find(({ id }) => id === selected.object)?.pose;
  return model.snapshot?.robots.find(({ id }) => id === selected.robot)?.motion[0]?.from;
}
