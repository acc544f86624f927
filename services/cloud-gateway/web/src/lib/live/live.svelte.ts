/** The one live stream of the page: the socket and the clock around LiveCore, and its rows for views. */
import { onDestroy } from 'svelte';
import { SvelteMap } from 'svelte/reactivity';
import { api } from '../api/client';
import type { DriveAnswer, Row, RowSource } from '../api/types';
import { LiveCore, SIGNED_OUT, type Act, type Phase, type Rows } from './core';

const TICK_MS = 100;
/** More than this has not left the page yet: the connection stalls, and what is said now would come late. */
const MOST_UNSENT = 2048;

type MessageListener = (messages: unknown[], leftOut: number) => void;

class LiveStream {
  phase = $state<Phase>('off');
  isLost = $state(true);
  /** Age of what is shown, whole seconds; nothing: nothing was received yet. */
  ageS = $state<number | null>(null);
  /** What the stream has refused: a fault of the page, shown as such. */
  refused = $state('');

  /** Of whom nothing is heard; one frame after the other says the same. */
  private silent = $state('');

  private readonly core = new LiveCore();
  private readonly versions = new SvelteMap<string, number>();
  private readonly listeners = new Set<MessageListener>();
  private readonly others = new Set<() => void>();
  private readonly drivers = new Set<(answer: DriveAnswer) => void>();
  private socket: WebSocket | null = null;
  private timer = 0;

  constructor() {
    this.core.onRows = (topic) => this.versions.set(topic, (this.versions.get(topic) ?? 0) + 1);
    this.core.onMessages = (messages, leftOut) => this.listeners.forEach((each) => each(messages, leftOut));
    this.core.onOther = () => this.others.forEach((each) => each());
    this.core.onDrive = (answer) => this.drivers.forEach((each) => each(answer));
  }

  start(): void {
    this.timer ||= window.setInterval(() => this.act(this.core.tick(performance.now())), TICK_MS);
    this.act(this.core.start(performance.now()));
  }

  stop(): void {
    window.clearInterval(this.timer);
    this.timer = 0;
    this.act(this.core.stop());
  }

  use(topic: string): () => void {
    this.act(this.core.use(topic));
    let used = true;
    return () => {
      if (used) this.act(this.core.leave(topic));
      used = false;
    };
  }

  /** Tracked: who reads it is run again when a row of the topic changes. */
  rows(topic: string): Rows {
    this.versions.get(topic);
    return this.core.rows(topic);
  }

  isKnown(topic: string): boolean {
    this.versions.get(topic);
    void this.silent;
    return this.core.isKnown(topic);
  }

  /** Rows of this service may be old or missing. */
  isSilent(source: RowSource): boolean {
    void this.silent;
    return this.core.isSilent(source);
  }

  /** The same rows for who draws by himself at each picture, such as a canvas. */
  rowsNow(topic: string): Rows {
    return this.core.rows(topic);
  }

  /** By the gateway's clock, once it has told it. */
  utcMs(): number {
    return this.core.utcAt(performance.now()) ?? Date.now();
  }

  listen(listener: MessageListener): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  /** Another gateway speaks from now on, which numbers messages anew. */
  onOther(listener: () => void): () => void {
    this.others.add(listener);
    return () => this.others.delete(listener);
  }

  /** A word of driving; false: it was not sent, and is not sent later. */
  say(word: string): boolean {
    if (this.core.phase !== 'open' || this.socket === null || this.socket.bufferedAmount > MOST_UNSENT) return false;
    this.socket.send(word);
    return true;
  }

  onDrive(listener: (answer: DriveAnswer) => void): () => void {
    this.drivers.add(listener);
    return () => this.drivers.delete(listener);
  }

  private act(act: Act): void {
    if (act.close) this.drop();
    if (act.connect) this.connect();
    for (const word of act.send) this.socket?.send(word);
    this.show();
  }

  private show(): void {
    this.phase = this.core.phase;
    this.isLost = this.core.isLost;
    this.silent = this.core.silent.join();
    this.refused = this.core.refused;
    const at = this.core.heardAt;
    this.ageS = at === null ? null : Math.max(0, Math.floor((performance.now() - at) / 1000));
  }

  private connect(): void {
    this.drop();
    const socket = new WebSocket(`${location.protocol === 'http:' ? 'ws' : 'wss'}://${location.host}/api/v1/live`);
    this.socket = socket;
    const mine = (then: () => void) => () => {
      if (this.socket === socket) then();
    };
    socket.onopen = mine(() => this.act(this.core.opened(performance.now())));
    socket.onmessage = (event) => {
      if (this.socket === socket) this.core.heard(String(event.data), performance.now());
      this.show();
    };
    socket.onclose = (event) => mine(() => this.onClosed(event.code))();
  }

  private onClosed(code: number): void {
    const wasConnecting = this.core.phase === 'connecting';
    this.socket = null;
    this.act(this.core.closed(code, performance.now()));
    if (code === SIGNED_OUT) api.signedOut();
    // A browser does not tell that an upgrade was refused, so the session is asked for. If it is over, the 401 tells.
    else if (wasConnecting) void api.get('/api/v1/session').catch(() => undefined);
  }

  private drop(): void {
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }
}

export const live = new LiveStream();

/** The rows of a topic while the component that calls it is shown. */
export function useTopic(topic: string): { readonly rows: Rows; readonly isKnown: boolean } {
  onDestroy(live.use(topic));
  return {
    get rows() {
      return live.rows(topic);
    },
    get isKnown() {
      return live.isKnown(topic);
    },
  };
}

export function rowsOf<Content>(rows: Rows, kind: Row['kind']): Row<Content>[] {
  return [...rows.values()].filter((row) => row.kind === kind) as Row<Content>[];
}
