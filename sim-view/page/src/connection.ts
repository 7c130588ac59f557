// The live source: a WebSocket to the server of the page.

import type { Look, Model, Source } from "./model";
import { type Command, type Message, PROTOCOL, type Request } from "./protocol";

/** Close code of the server for a page whose token is wrong. */
const WRONG_TOKEN = 4401;
/** Close code of the server for a page with another version of the protocol. */
const WRONG_VERSION = 4406;
const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 8000;
/** A connection that lasts this long resets the waiting time. */
const STEADY_MS = 5000;

export class LiveSource implements Source {
  readonly player = null;
  private socket: WebSocket | null = null;
  private wanted: Look | null = null;
  private number = 0;
  private wait_ms = FIRST_WAIT_MS;
  private retrying = 0;
  private readonly pending = new Map<number, { done: () => void; fail: (why: Error) => void }>();

  constructor(private readonly model: Model) {
    this.connect();
    // The user has opened the address of another eyesim in this tab: only the fragment with the token has changed.
    addEventListener("hashchange", () => tokenInAddress() !== null && this.reconnect());
  }

  act(command: Command): Promise<void> {
    if (this.socket?.readyState !== WebSocket.OPEN) return Promise.reject(new Error("not connected"));
    const number = ++this.number;
    return new Promise((done, fail) => {
      this.pending.set(number, { done, fail });
      this.send({ type: "act", number, command });
    });
  }

  look(look: Look): void {
    this.wanted = look;
    this.send({ type: "look", ...look });
  }

  private connect(): void {
    this.model.setConnection({ is: "connecting" });
    const address = new URL("ws", document.baseURI);
    address.protocol = address.protocol.replace("http", "ws");
    address.hash = "";
    const socket = new WebSocket(address);
    this.socket = socket;
    let opened_ms = Infinity;
    socket.onopen = () => {
      opened_ms = performance.now();
      this.send({ type: "hello", protocol: PROTOCOL, token: token() });
      if (this.wanted) this.look(this.wanted);
    };
    socket.onmessage = (event) => this.receive(JSON.parse(String(event.data)) as Message);
    socket.onclose = (event) => {
      this.failPending();
      if (event.code === WRONG_TOKEN) storeToken(null);
      if (event.code === WRONG_VERSION && reloadOnce(event.reason)) return;
      if (event.code === WRONG_TOKEN || event.code === WRONG_VERSION) {
        this.model.setConnection({ is: "refused", why: event.reason || "the server refused this page" });
        return;
      }
      if (performance.now() - opened_ms > STEADY_MS) this.wait_ms = FIRST_WAIT_MS;
      this.retry(event.reason || "no answer from eyesim");
    };
  }

  private failPending(): void {
    for (const { fail } of this.pending.values()) fail(new Error("the connection was lost"));
    this.pending.clear();
  }

  /** Replaces the connection. */
  private reconnect(): void {
    clearTimeout(this.retrying);
    this.wait_ms = FIRST_WAIT_MS;
    if (this.socket) {
      this.socket.onopen = this.socket.onmessage = this.socket.onclose = null;
      this.socket.close();
    }
    this.failPending();
    this.connect();
  }

  private retry(why: string): void {
    this.model.setConnection({ is: "lost", why, again_ms: performance.now() + this.wait_ms });
    this.retrying = window.setTimeout(() => this.connect(), this.wait_ms);
    this.wait_ms = Math.min(2 * this.wait_ms, LONGEST_WAIT_MS);
  }

  private receive(message: Message): void {
    if (message.type === "answer") {
      const waiting = this.pending.get(message.number);
      this.pending.delete(message.number);
      if (message.refused === null) waiting?.done();
      else waiting?.fail(new Error(message.refused));
      return;
    }
    if (message.type === "welcome") this.model.setConnection({ is: "open" });
    this.model.receive(message);
  }

  private send(request: Request): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(request));
  }
}

function tokenInAddress(): string | null {
  return new URLSearchParams(location.hash.slice(1)).get("token");
}

/** The token in the page's address, which is stored for this tab and removed from the address bar. */
function token(): string | null {
  const given = tokenInAddress();
  if (given !== null) {
    storeToken(given);
    history.replaceState(null, "", location.pathname + location.search);
  }
  try {
    return sessionStorage.getItem("token");
  } catch {
    return tokenOfPage;
  }
}

/** The token until the page is reloaded, if the browser forbids storage. */
let tokenOfPage: string | null = null;

function storeToken(token: string | null): void {
  tokenOfPage = token;
  try {
    if (token === null) sessionStorage.removeItem("token");
    else sessionStorage.setItem("token", token);
  } catch {
    // Without storage, a reloaded page has no token.
  }
}

/** Reloads the page for a server of another version, once for each reason. */
function reloadOnce(why: string): boolean {
  try {
    if (sessionStorage.getItem("reloaded") === why) return false;
    sessionStorage.setItem("reloaded", why);
  } catch {
    return false;
  }
  location.reload();
  return true;
}
