// A virtual list: only the visible lines are elements.

import { element } from "../dom";

const ROW_PX = 22;
const MARGIN_ROWS = 6;

/** A line of a list. */
export interface Line {
  /** Number that identifies the line. */
  key: number;
  time: string;
  who: string;
  kind: string;
  text: string;
}

/** A list box with one tab stop; arrow keys, Page Up, Page Down, Home and End move in it, Enter or a click chooses. */
export class LongList {
  readonly element: HTMLElement;
  private readonly room = element("div", { className: "room", role: "presentation" });
  private lines: readonly Line[] = [];
  private active: number | undefined;
  private isAtEnd = true;
  private frame = 0;

  constructor(
    private readonly testid: string,
    label: string,
    private readonly choose: (line: Line) => void,
  ) {
    this.element = element("div", { className: "long-list", role: "listbox", tabIndex: 0, testid, label }, [this.room]);
    this.element.addEventListener("scroll", () => this.scrolled());
    this.element.addEventListener("keydown", (event) => this.pressed(event));
    this.element.addEventListener("click", (event) => this.clicked(event));
    new ResizeObserver(() => this.draw()).observe(this.element);
  }

  /** Shows these lines; stays at the end if it was there. */
  show(lines: readonly Line[]): void {
    this.lines = lines;
    this.room.style.height = `${lines.length * ROW_PX}px`;
    if (this.isAtEnd) this.element.scrollTop = lines.length * ROW_PX;
    this.draw();
  }

  /** Marks a line and scrolls it into view. */
  mark(key: number): void {
    const at = this.lines.findIndex((line) => line.key === key);
    if (at < 0) return;
    this.active = key;
    const [top, height] = [at * ROW_PX, this.element.clientHeight];
    const { scrollTop } = this.element;
    if (top < scrollTop || top + ROW_PX > scrollTop + height) this.element.scrollTop = top - height / 2;
    this.draw();
  }

  private scrolled(): void {
    const { scrollTop, clientHeight, scrollHeight } = this.element;
    this.isAtEnd = scrollTop + clientHeight >= scrollHeight - ROW_PX;
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.draw());
  }

  private draw(): void {
    const first = Math.max(0, Math.floor(this.element.scrollTop / ROW_PX) - MARGIN_ROWS);
    const count = Math.ceil(this.element.clientHeight / ROW_PX) + 2 * MARGIN_ROWS;
    const visible = this.lines.slice(first, first + count);
    this.room.replaceChildren(...visible.map((line, index) => this.row(line, first + index)));
    const active = visible.find((line) => line.key === this.active);
    if (active) this.element.setAttribute("aria-activedescendant", this.id(active));
    else this.element.removeAttribute("aria-activedescendant");
  }

  private row(line: Line, at: number): HTMLElement {
    const row = element("div", {
      id: this.id(line),
      className: "row",
      role: "option",
      ariaPosInSet: String(at + 1),
      ariaSetSize: String(this.lines.length),
      ariaSelected: String(line.key === this.active),
      title: line.text,
    });
    row.dataset["kind"] = line.kind;
    for (const className of ["time", "who", "kind", "text"] as const)
      if (line[className] || className === "who") row.append(element("span", { className, textContent: `${line[className]} ` }));
    row.style.transform = `translateY(${at * ROW_PX}px)`;
    return row;
  }

  private id(line: Line): string {
    return `${this.testid}-${line.key}`;
  }

  private clicked(event: MouseEvent): void {
    const row = (event.target as Element).closest("[role=option]");
    const line = row && this.lines.find((line) => this.id(line) === row.id);
    if (!line) return;
    this.mark(line.key);
    this.choose(line);
  }

  private pressed(event: KeyboardEvent): void {
    const at = this.lines.findIndex((line) => line.key === this.active);
    const page = Math.max(1, Math.floor(this.element.clientHeight / ROW_PX) - 1);
    const last = this.lines.length - 1;
    const next = ({
      ArrowDown: at < 0 ? Math.floor(this.element.scrollTop / ROW_PX) : at + 1,
      ArrowUp: at < 0 ? last : at - 1,
      PageDown: at + page,
      PageUp: at - page,
      Home: 0,
      End: last,
    } as Record<string, number>)[event.key];
    const line = this.lines[at];
    if (next !== undefined && last >= 0) {
      this.mark(this.lines[Math.min(last, Math.max(0, next))]!.key);
    } else if (event.key === "Enter" && line) {
      this.choose(line);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }
}
