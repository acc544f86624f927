/**
 * The page's side of /api/v1/live, without a socket or a clock: words and times in, words to send and waits out.
 *
 * | State      | Event                        | Does                                              | Next       |
 * |------------|------------------------------|---------------------------------------------------|------------|
 * | off        | start                        | connect                                           | connecting |
 * | connecting | opened                       | subscribe every topic, resume those that are known | open       |
 * | connecting | closed, 3 s without an answer | wait 0.25 s, doubled each time, 1 s at most;      | waiting    |
 * |            |                              | drop snapshots that are not whole                 |            |
 * |            | (8 s once the wait is 1 s)   |                                                   |            |
 * | open       | frame                        | rows of its blocks                                | open       |
 * | open       | closed, 3 s without a frame  | as above                                          | waiting    |
 * | waiting    | the wait is over             | connect                                           | connecting |
 * | any        | closed with 4401, stop       | forget everything                                 | off        |
 */
import type { DriveAnswer, RemovedRow, Row, RowSource } from '../api/types';

export const SIGNED_OUT = 4401;
const QUIET_MS = 3000; // the gateway sends a frame each second, even if nothing has changed
/** After many tries that failed, Chromium keeps each new one back for up to 5 s. Given up before, it is never let go. */
const HELD_BACK_MS = 8000;
const FIRST_WAIT_MS = 250;
const MOST_WAIT_MS = 1000;
/** By the first word of a topic: whose table its rows are. Those of runs in `fleet` are the scheduler's. */
const SOURCES: Record<string, RowSource> = {
  fleet: 'router', robot: 'router', sensor: 'router', run: 'scheduler', alerts: 'resilience',
};

export type Phase = 'off' | 'connecting' | 'open' | 'waiting';
export type Notice = 'dropped' | 'too_old' | 'restarted';

interface Block {
  topic: string;
  begins: boolean;
  snapshot: boolean;
  more: boolean;
  to: number;
  rows: (Row | RemovedRow)[];
}

export interface Frame {
  count: number;
  head: number;
  time: string;
  silent?: RowSource[];
  notices: { topic: string; kind: Notice }[];
  left_out: number;
  messages: unknown[];
  blocks: Block[];
}

export interface Act {
  connect?: true;
  close?: true;
  send: string[];
}

export type Rows = Map<string, Row>;

export function keyOf(row: { kind: string; node: string; name: string }): string {
  return `${row.kind}/${row.node}/${row.name}`;
}

/**
 * Rows of one topic. A snapshot replaces the rows only once it is whole: nobody sees half a fleet. Changed rows are another
 * Map: who keeps one in a $derived is told of the change only by that.
 */
class TopicTable {
  rows: Rows = new Map();
  isKnown = false;
  users = 0;
  private coming: Rows | null = null;

  take(block: Block): void {
    if (block.snapshot && block.begins) this.coming = new Map();
    if (this.coming === null && block.rows.length > 0) this.rows = new Map(this.rows);
    const rows = this.coming ?? this.rows;
    for (const row of block.rows) put(rows, row);
    if (block.more || this.coming === null) return;
    this.rows = this.coming;
    this.coming = null;
    this.isKnown = true;
  }

  restart(): void {
    this.coming = null;
  }
}

function put(rows: Rows, row: Row | RemovedRow): void {
  if ('removed' in row) rows.delete(keyOf(row));
  else rows.set(keyOf(row), row);
}

/** The instance has 64 bits: as a number of JavaScript it would lose some. */
function instanceIn(text: string): string {
  return /"instance":(\d+)/.exec(text.slice(0, 300))?.[1] ?? '';
}

export class LiveCore {
  phase: Phase = 'off';
  /** When the last frame came, by the clock of now(); nothing: none yet. */
  heardAt: number | null = null;
  leftOut = 0;
  /** What the gateway refused last; it does not say which topic it was. Empty: nothing, or it is of no matter any more. */
  refused = '';
  /** Of whom nothing is heard, as the last frame says. */
  silent: RowSource[] = [];
  onRows: (topic: string) => void = () => {};
  /** Another gateway, or the same one anew, speaks: it numbers messages from 1. Told before its first messages. */
  onOther: () => void = () => {};
  onMessages: (messages: unknown[], leftOut: number) => void = () => {};
  onDrive: (answer: DriveAnswer) => void = () => {};

  /** The gateway's UTC in ms, less the clock of now(); nothing: not told yet. */
  private utcLess: number | null = null;
  private readonly topics = new Map<string, TopicTable>();
  /** Which topics the refusal may be of: those that had no rows yet. Without one it was a drive. */
  private readonly mayBeRefused = new Set<string>();
  private instance = '';
  private resumeFrom = 0;
  private wait = FIRST_WAIT_MS;
  /** When the phase began. */
  private since = 0;

  /** True: what is shown may be old, and nothing newer comes at the moment. */
  get isLost(): boolean {
    return this.phase !== 'open' || this.heardAt === null || this.heardAt < this.since;
  }

  start(now: number): Act {
    if (this.phase !== 'off') return { send: [] };
    return this.connect(now);
  }

  stop(): Act {
    this.forget();
    return { close: true, send: [] };
  }

  opened(now: number): Act {
    this.phase = 'open';
    this.since = now;
    this.refuse('');
    return { send: [...this.topics].map(([topic, table]) => this.subscription(topic, table)) };
  }

  closed(code: number, now: number): Act {
    if (code === SIGNED_OUT) this.forget();
    if (this.phase !== 'off' && this.phase !== 'waiting') this.lose(now);
    return { send: [] };
  }

  tick(now: number): Act {
    if (this.phase === 'waiting' && now - this.since >= this.wait) {
      this.wait = Math.min(this.wait * 2, MOST_WAIT_MS);
      return this.connect(now);
    }
    const quiet = now - Math.max(this.since, this.phase === 'open' ? (this.heardAt ?? 0) : 0);
    if ((this.phase !== 'open' && this.phase !== 'connecting') || quiet < this.patience) return { send: [] };
    this.lose(now);
    return { close: true, send: [] };
  }

  /** The first user of a topic subscribes it, the last one ends it. */
  use(topic: string): Act {
    const table = this.topics.get(topic) ?? new TopicTable();
    this.topics.set(topic, table);
    const isNew = ++table.users === 1;
    return { send: isNew && this.phase === 'open' ? [this.subscription(topic, table)] : [] };
  }

  leave(topic: string): Act {
    const table = this.topics.get(topic);
    if (table === undefined || --table.users > 0) return { send: [] };
    this.topics.delete(topic);
    this.settle(topic);
    return { send: this.phase === 'open' ? [JSON.stringify({ unsubscribe: topic })] : [] };
  }

  rows(topic: string): Rows {
    return this.topics.get(topic)?.rows ?? new Map();
  }

  /** All its rows are here: what has no row is not there. */
  isKnown(topic: string): boolean {
    const source = SOURCES[topic.split('/')[0] ?? ''];
    return (this.topics.get(topic)?.isKnown ?? false) && (source === undefined || !this.isSilent(source));
  }

  /** Its first table has not come, or no further one: rows of it may be old or missing. */
  isSilent(source: RowSource): boolean {
    return this.silent.includes(source);
  }

  /** The gateway's UTC, ms: rows have its times, and the browser's own clock may be off. Nothing: not told yet. */
  utcAt(now: number): number | null {
    return this.utcLess === null ? null : this.utcLess + now;
  }

  heard(text: string, now: number): void {
    const word = JSON.parse(text) as Frame & { error?: { detail?: string }; drive?: DriveAnswer };
    if (word.error !== undefined) return this.refuse(word.error.detail ?? '');
    if (word.drive !== undefined) {
      this.settle('');
      return this.onDrive(word.drive);
    }
    this.heardAt = now;
    const utc = Date.parse(word.time);
    if (!Number.isNaN(utc)) this.utcLess = utc - now;
    this.wait = FIRST_WAIT_MS;
    const before = this.instance;
    this.instance = instanceIn(text);
    if (before !== '' && before !== this.instance) this.onOther();
    this.silent = word.silent ?? [];
    for (const notice of word.notices) this.topics.get(notice.topic)?.restart();
    for (const block of word.blocks) this.take(block);
    if (word.messages.length > 0 || word.left_out > 0) this.onMessages(word.messages, word.left_out);
    if (!word.blocks.some((block) => block.more)) this.resumeFrom = word.head;
  }

  private take(block: Block): void {
    const table = this.topics.get(block.topic);
    if (table === undefined) return; // left a moment ago
    table.take(block);
    if (this.mayBeRefused.has(block.topic)) this.settle(block.topic);
    this.onRows(block.topic);
  }

  private refuse(detail: string): void {
    this.refused = detail;
    this.mayBeRefused.clear();
    for (const [topic, table] of this.topics) {
      if (!table.isKnown && topic !== 'messages') this.mayBeRefused.add(topic); // that one never has rows
    }
  }

  /** The topic has its rows, or nobody wants it any more. */
  private settle(topic: string): void {
    this.mayBeRefused.delete(topic);
    if (this.mayBeRefused.size === 0) this.refused = '';
  }

  private subscription(topic: string, table: TopicTable): string {
    const word = JSON.stringify({ subscribe: topic });
    if (!table.isKnown || this.instance === '') return word;
    return `${word.slice(0, -1)},"instance":${this.instance},"from":${this.resumeFrom}}`;
  }

  private get patience(): number {
    return this.phase === 'connecting' && this.wait === MOST_WAIT_MS ? HELD_BACK_MS : QUIET_MS;
  }

  private connect(now: number): Act {
    this.phase = 'connecting';
    this.since = now;
    return { connect: true, send: [] };
  }

  /** What comes on the next connection follows the last whole rows: added to half a snapshot it would pass for all. */
  private lose(now: number): void {
    this.phase = 'waiting';
    this.since = now;
    for (const table of this.topics.values()) table.restart();
  }

  private forget(): void {
    this.phase = 'off';
    this.instance = '';
    this.refuse('');
    this.silent = [];
    this.heardAt = null;
    this.wait = FIRST_WAIT_MS;
    for (const table of this.topics.values()) {
      table.rows = new Map();
      table.isKnown = false;
      table.restart();
    }
  }
}
