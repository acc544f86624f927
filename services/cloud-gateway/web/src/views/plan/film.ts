/** A simulated run as a film: what is to be seen at a time, in s since the run's submission, as the timeline has it. */
import type { Schemas } from '../../lib/api/types';
import type { RobotState } from '../../lib/fleet/robot_state';
import type { Point } from '../../lib/map/camera';
import { spanOf, type Bar } from '../runs/timeline';
import type { Simulation } from './plan_job';
import type { Answer } from './plan_result';
import { allBars, taskOfRun } from './plan_runs';

type Happening = Schemas['SimulationHappening'];
type Sending = Schemas['SimulationSending'];

export interface Film {
  end: number;
  /** The cloud first. */
  nodes: string[];
  tasks: string[];
  bars: Bar[];
  sendings: Sending[];
  happenings: Happening[];
  /** Where a task leads to: a place of the hall, by the task's id. */
  goals: Map<string, string>;
}

/** Of a task as it is now. */
export type Stage = 'WAITING' | 'RUNNING' | 'FINISHED' | 'FAILED';

export interface Actor {
  id: string;
  state: RobotState;
  task: string | null;
}

export interface Flight {
  from: string;
  to: string;
  phase: Sending['phase'];
  /** 0: it is sent, 1: it is there. */
  part: number;
}

export interface Scene {
  actors: Actor[];
  stages: Map<string, Stage>;
  flights: Flight[];
  /** Pairs between which something does not arrive. */
  cuts: [string, string][];
}

/** What follows the last task is shown so long. */
const TAIL_S = 3;
/** A message is there within milliseconds: nobody would see it. */
export const FLIGHT_S = 0.6;

export function filmOf(one: Simulation, answer: Answer): Film {
  const from = answer.world?.submitted_s ?? 0;
  const bars = allBars(answer);
  const end = endOf(answer, bars, from);
  const since = <Of extends { at_s: number }>(all: Of[]): Of[] => all.map((of) => ({ ...of, at_s: of.at_s - from })).filter((of) => of.at_s <= end);
  const sendings = since(answer.sendings).filter((of) => of.at_s >= 0);
  const planned = plannedTasks(one);
  const counted = () => Array.from({ length: Math.min(one.tasks, 2000) }, (_, i) => `t${i}`);
  const tasks = [...new Set([...(planned?.map((task) => task.id) ?? counted()), ...bars.map((bar) => bar.task)])];
  const nodes = new Set(['cloud', ...sendings.flatMap((of) => [of.from, of.to]), ...bars.map((bar) => bar.robot)]);
  const happenings = since(answer.happenings);
  for (const { node, other, nodes: side = [] } of happenings) for (const id of [node, other, ...side]) if (id !== undefined) nodes.add(id);
  if (planned === null && one.robots <= 100) for (let i = 0; i < one.robots; i++) nodes.add(`r${i}`);
  const goals = new Map((planned ?? []).flatMap(({ id, data }) => (typeof data?.place === 'string' ? [[id, data.place] as const] : [])));
  return { end, nodes: [...nodes], tasks, bars, sendings, happenings, goals };
}

interface PlannedTask {
  id: string;
  data?: Record<string, unknown>;
}

/** Those of its scenarios, as the bars name them; nothing: it has none. */
function plannedTasks({ job }: Simulation): PlannedTask[] | null {
  if (job.scenario === undefined) return null;
  const scenarios = [job.scenario, ...(job.beside ?? []).map((one) => one.scenario)] as unknown as { tasks?: PlannedTask[] }[];
  const named = (task: PlannedTask, run: number) => (scenarios.length === 1 ? task : { ...task, id: taskOfRun(run, task.id) });
  return scenarios.flatMap(({ tasks = [] }, i) => tasks.map((task) => named(task, i + 1)));
}

/** Of what was under way to the end of all that was simulated; else until nothing happens any more. */
function endOf(answer: Answer, bars: Bar[], from: number): number {
  if (bars.some((bar) => bar.state === 'RUNNING')) return spanOf(bars, answer.seconds - from);
  return spanOf(bars, Math.max(0, ...answer.happenings.map((one) => one.at_s - from))) + TAIL_S;
}

export function sceneAt(film: Film, time: number, flightS = FLIGHT_S): Scene {
  const past = film.happenings.filter((one) => one.at_s <= time);
  const stages = new Map<string, Stage>(film.tasks.map((task) => [task, 'WAITING']));
  const at = new Map<string, string>();
  for (const bar of film.bars) {
    if (bar.start === null || bar.start > time) continue;
    // When one of the paper's attempts failed is not known: it was before the next one of its task.
    const isReplaced = bar.state === 'FAILED' && bar.end === null && (time >= film.end || film.bars.some((one) => one.task === bar.task && one.start! > bar.start! && one.start! <= time));
    const isOver = isReplaced || (bar.end !== null && bar.end <= time);
    stages.set(bar.task, isOver ? (bar.state === 'FINISHED' ? 'FINISHED' : 'FAILED') : 'RUNNING');
    if (!isOver) at.set(bar.robot, bar.task);
  }
  return { actors: film.nodes.map((id) => actorOf(id, past, at.get(id) ?? null)), stages, flights: flightsAt(film, time, flightS), cuts: cutsOf(film.nodes, past) };
}

function actorOf(id: string, past: Happening[], task: string | null): Actor {
  const last = (kinds: string[]) => past.filter((one) => one.node === id && kinds.includes(one.kind)).at(-1)?.kind;
  if (last(['kill', 'start']) === 'kill') return { id, state: 'offline', task: null };
  if (last(['fail', 'repair']) === 'fail') return { id, state: 'failed', task };
  return { id, state: task === null ? 'ready' : 'atWork', task };
}

function flightsAt(film: Film, time: number, flightS: number): Flight[] {
  return film.sendings.filter((one) => one.at_s <= time && time < one.at_s + flightS)
    .map(({ from, to, phase, at_s }) => ({ from, to, phase, part: (time - at_s) / flightS }));
}

/** Each pair once, in whichever way nothing arrives. */
function cutsOf(nodes: string[], past: Happening[]): [string, string][] {
  const cut = new Set<string>();
  for (const one of past) {
    if (one.kind !== 'cut' && one.kind !== 'partition' && one.kind !== 'heal') continue;
    const here = new Set(one.nodes ?? [one.node ?? '']);
    for (const a of here) {
      for (const b of nodes) {
        if (here.has(b) || (one.other !== undefined && one.other !== b)) continue;
        for (const way of [...(one.way === 'back' ? [] : [`${a} ${b}`]), ...(one.way === 'there' ? [] : [`${b} ${a}`])]) {
          if (one.kind === 'heal') cut.delete(way);
          else cut.add(way);
        }
      }
    }
  }
  const pairs = new Set([...cut].map((way) => way.split(' ').sort().join(' ')));
  return [...pairs].map((pair) => pair.split(' ') as [string, string]);
}

/** The times at which something changes: a task begins or ends, something goes wrong. */
export function changesOf(film: Film): number[] {
  const times = [...film.bars.flatMap((bar) => [bar.start, bar.end]), ...film.happenings.map((one) => one.at_s)];
  return [...new Set(times.filter((time): time is number => time !== null && time >= 0))].sort((a, b) => a - b);
}

/** Where everybody stands who has no place of his own: the cloud above, robots on an ellipse around the hall's middle. */
export function standsOf(nodes: string[], known: Map<string, Point>, box: { west: number; south: number; east: number; north: number }): Map<string, Point> {
  const middle = { x: (box.west + box.east) / 2, y: (box.south + box.north) / 2 };
  const others = nodes.filter((id) => id !== 'cloud' && !known.has(id));
  const out = new Map<string, Point>([['cloud', { x: middle.x, y: known.size > 0 ? box.north - 0.5 : middle.y }]]);
  others.forEach((id, i) => {
    const angle = Math.PI / 2 - (2 * Math.PI * (i + 0.5)) / others.length;
    out.set(id, { x: middle.x + 0.42 * (box.east - box.west) * Math.cos(angle), y: middle.y + 0.42 * (box.north - box.south) * Math.sin(angle) });
  });
  for (const [id, point] of known) out.set(id, point);
  return out;
}

function partOf(begin: number, end: number, time: number): number {
  return time >= end ? 1 : (time - begin) / (end - begin);
}

/** On its way to the place of a task, straight; `isCalm`: it is there when the task is done. */
export function pointAt(film: Film, robot: string, stand: Point, places: Map<string, Point>, time: number, isCalm: boolean): Point {
  let at = stand;
  for (const bar of film.bars) {
    const goal = places.get(film.goals.get(bar.task) ?? '');
    if (bar.robot !== robot || goal === undefined || bar.start === null || bar.start > time) continue;
    if (bar.state === 'FAILED') continue; // where it came to is not known
    const part = isCalm && (bar.end === null || time < bar.end) ? 0 : partOf(bar.start, bar.end ?? film.end, time);
    at = { x: at.x + part * (goal.x - at.x), y: at.y + part * (goal.y - at.y) };
  }
  return at;
}
