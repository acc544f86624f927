/**
 * A scenario as a person edits it: each function gives a new one and leaves the old one as it was. What the page does
 * not know stays where it is, so that a file of `trb` comes back as it was.
 */
export interface Condition {
  sensor?: string | undefined;
  of?: string | undefined;
  identity?: string | undefined;
  op?: string | undefined;
  value?: number | string | undefined;
  unit?: string | undefined;
}

export interface Task {
  id: string;
  robot?: string;
  requires?: string[];
  skill?: string;
  data?: Record<string, unknown>;
  after?: string[];
  when?: Condition;
  // What somebody typed that is no number stays text: the check says so.
  timeout_s?: number | string;
  retries?: number | string;
  retry_after_s?: number | string;
  on_failure?: string;
  start_within_s?: number | string;
  pinned?: boolean;
  [more: string]: unknown;
}

export interface Scenario {
  name: string;
  description?: string;
  repeat?: number;
  tasks: Task[];
  [more: string]: unknown;
}

/** A key that is undefined leaves the file. */
export type Change = { [Key in keyof Task]?: Task[Key] | undefined };

export const comparisons = ['<', '<=', '>', '>=', '==', '!='];
export const failures = ['resilience', 'skip', 'continue', 'abort'];
const ID = /^[a-z][a-z0-9_-]{0,63}$/;

export const emptyScenario = (): Scenario => ({ name: '', tasks: [] });

/** What a text says; nothing if it is no JSON, or not of that shape. */
export function parsed(text: string): Scenario | null {
  try {
    const value: unknown = JSON.parse(text);
    if (typeof value !== 'object' || value === null || Array.isArray(value)) return null;
    const tasks = (value as { tasks?: unknown }).tasks;
    if (!Array.isArray(tasks) || tasks.some((task) => typeof task !== 'object' || task === null || Array.isArray(task))) return null;
    return value as Scenario;
  } catch {
    return null;
  }
}

/** A list of words, as a file has to have it; what somebody stored instead of one is none. */
export function wordsIn(value: unknown): string[] {
  return Array.isArray(value) ? value.filter((one): one is string => typeof one === 'string') : [];
}

export const textOf = (scenario: Scenario): string => `${JSON.stringify(scenario, null, 2)}\n`;

/** Names like `go_to`, `go_to_2`. */
export function freshId(scenario: Scenario, wish: string): string {
  const plain = wish.toLowerCase().replace(/[^a-z0-9_-]/g, '_').replace(/^[^a-z]+/, '').slice(0, 56) || 'task';
  const taken = new Set(scenario.tasks.map((task) => task.id));
  if (!taken.has(plain)) return plain;
  for (let number = 2; ; ++number) if (!taken.has(`${plain}_${number}`)) return `${plain}_${number}`;
}

export function isFreeId(scenario: Scenario, id: string, own: string): boolean {
  return ID.test(id) && (id === own || scenario.tasks.every((task) => task.id !== id));
}

export function withTask(scenario: Scenario, task: Task): Scenario {
  return { ...scenario, tasks: [...scenario.tasks, task] };
}

/** Keys that are undefined or empty leave the file. */
export function changed(scenario: Scenario, id: string, change: Change): Scenario {
  return mapped(scenario, (task) => (task.id === id ? without(task, change) : task));
}

/** Who followed it, and who took a value of its result, names it by its new id. */
export function renamed(scenario: Scenario, id: string, to: string): Scenario {
  const name = (one: string) => (one === id ? to : one);
  return mapped(scenario, (task) => {
    const out: Task = { ...task, id: name(task.id) };
    if (Array.isArray(task.after)) out.after = task.after.map(name);
    if (typeof task.data === 'object' && task.data !== null) {
      out.data = Object.fromEntries(Object.entries(task.data).map(([key, value]) => [key, sourceOf(value) === id ? { ...(value as object), from: to } : value]));
    }
    return out;
  });
}

/** Who followed it follows those that it followed. */
export function withoutTask(scenario: Scenario, id: string): Scenario {
  const before = wordsIn(scenario.tasks.find((task) => task.id === id)?.after);
  const rest = { ...scenario, tasks: scenario.tasks.filter((task) => task.id !== id) };
  return mapped(rest, (task) => {
    const after = wordsIn(task.after);
    if (!after.includes(id)) return task;
    return without(task, { after: [...new Set(after.flatMap((one) => (one === id ? before : [one])))] });
  });
}

export function copied(scenario: Scenario, id: string): { scenario: Scenario; id: string } {
  const task = scenario.tasks.find((one) => one.id === id);
  if (!task) return { scenario, id };
  const to = freshId(scenario, String(id).replace(/_\d+$/, ''));
  return { scenario: withTask(scenario, { ...structuredClone(task), id: to }), id: to };
}

/** `to` follows `from`. Nothing changes if it does so already, or if `from` would then follow itself. */
export function connected(scenario: Scenario, from: string, to: string): Scenario {
  const task = scenario.tasks.find((one) => one.id === to);
  const after = wordsIn(task?.after);
  if (!task || after.includes(from) || wouldCircle(scenario, from, to)) return scenario;
  return changed(scenario, to, { after: [...after, from] });
}

export function disconnected(scenario: Scenario, from: string, to: string): Scenario {
  const task = scenario.tasks.find((one) => one.id === to);
  const after = wordsIn(task?.after);
  return after.includes(from) ? changed(scenario, to, { after: after.filter((one) => one !== from) }) : scenario;
}

export function wouldCircle(scenario: Scenario, from: string, to: string): boolean {
  const before = new Map(scenario.tasks.map((task) => [task.id, wordsIn(task.after)]));
  const seen = new Set<string>();
  const waiting = [from];
  for (let one = waiting.pop(); one !== undefined; one = waiting.pop()) {
    if (one === to) return true;
    if (seen.has(one)) continue;
    seen.add(one);
    waiting.push(...(before.get(one) ?? []));
  }
  return false;
}

/** The places of those that each task follows, for the layout. */
export function afterOf(scenario: Scenario): number[][] {
  const places = new Map(scenario.tasks.map((task, place) => [task.id, place]));
  return scenario.tasks.map((task) => wordsIn(task.after).flatMap((one) => places.get(one) ?? []));
}

/** The task from whose result a parameter takes its value. */
export function sourceOf(value: unknown): string | null {
  const from = (value as { from?: unknown } | null)?.from;
  return typeof value === 'object' && typeof from === 'string' ? from : null;
}

function mapped(scenario: Scenario, change: (task: Task) => Task): Scenario {
  return { ...scenario, tasks: scenario.tasks.map(change) };
}

function without(task: Task, change: Change): Task {
  const out = { ...task, ...change } as Task;
  for (const [key, value] of Object.entries(change)) if (isEmpty(value)) delete out[key];
  return out;
}

function isEmpty(value: unknown): boolean {
  if (value === undefined || value === '' || value === false) return true;
  return typeof value === 'object' && value !== null && Object.keys(value).length === 0;
}
