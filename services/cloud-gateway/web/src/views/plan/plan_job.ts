/** What is wished, as a job of the gateway: POST /api/v1/simulations. */
import type { Schemas } from '../../lib/api/types';
import type { Scenario } from '../../lib/scenario/scenario_model';
import { besideOf, besideWishOf, type BesideWish } from './beside_wish';
import { faultsOf, WISHED_KINDS, wishesOf, type FaultWish, type JobFault, type WishedKind } from './fault_wish';
import { linkOf, linkWishOf, newLink, type LinkWish } from './link_wish';
import { sensorOf, sensorWishOf, type SensorWish } from './sensor_wish';

export type Simulation = Schemas['Simulation'];
/** By its id alone. */
export type Started = Schemas['SimulationStarted'];
export type Job = Schemas['SimulationJob'];
export type Protocol = NonNullable<Job['protocol']>;
export type FaultKind = 'fail' | 'cut' | 'kill';

export interface Wish {
  protocol: Protocol;
  robots: number;
  tasks: number;
  taskSeconds: number;
  /** How many robots something happens to. */
  faults: number;
  /** Of the real cores: */
  faultKind: FaultKind;
  /** What goes wrong besides. */
  more: FaultWish[];
  link: LinkWish;
  relays: string[];
  sensorValues: SensorWish[];
  /** With a scenario: others at the same time. */
  beside: BesideWish[];
  seed: number;
  /** Of the paper's protocol: robots that are told field by field, and sensors that send once a second. */
  interpreted: number;
  sensors: number;
}

export const PROTOCOLS: Protocol[] = ['talkrobots', 'paper'];
export const FAULT_KINDS: FaultKind[] = ['fail', 'cut', 'kill'];
/** How long a robot is cut off, or its computer is off, s. */
export const AWAY_S = 10;
export const MOST_SEED = 999_999;

export const FIRST: Wish = {
  protocol: 'talkrobots', robots: 5, tasks: 9, taskSeconds: 3, faults: 0, faultKind: 'fail', more: [], link: newLink('wifi'), relays: [], sensorValues: [], beside: [],
  seed: 1, interpreted: 0, sensors: 0,
};

/** What the sliders offer: of the real cores no more than a minute may take. */
export function mostOf(protocol: Protocol): { robots: number; tasks: number } {
  return protocol === 'paper' ? { robots: 1000, tasks: 2000 } : { robots: 40, tasks: 200 };
}

/** Of the paper's protocol each fault is at a task of its own, and one robot is left. */
export function mostFaults(wish: Wish): number {
  const others = Math.max(0, wish.robots - 1);
  return wish.protocol === 'paper' ? Math.min(others, wish.tasks) : Math.min(others, 100 / 2);
}

/** The same wish within the bounds. */
export function within(wish: Wish): Wish {
  const most = mostOf(wish.protocol);
  const out = { ...wish, robots: Math.min(wish.robots, most.robots), tasks: Math.min(wish.tasks, most.tasks) };
  const seed = Number.isFinite(wish.seed) ? Math.min(Math.max(0, Math.round(wish.seed)), MOST_SEED) : FIRST.seed;
  return { ...out, seed, faults: Math.min(wish.faults, mostFaults(out)), interpreted: Math.min(wish.interpreted, out.robots) };
}

export function jobOf(wish: Wish): Job {
  const { protocol, robots, tasks, taskSeconds, seed, interpreted, sensors } = within(wish);
  const common = { protocol, robots, tasks, task_seconds: taskSeconds };
  if (protocol === 'paper') return { ...common, interpreted, sensors, rate: 1, faulty: within(wish).faults };
  return { ...common, seed, ...surroundingsOf(wish), faults: [...slidFaults(within(wish)), ...wish.more.flatMap(faultsOf)] };
}

/** What a scenario is played in. */
function surroundingsOf(wish: Wish): Pick<Job, 'link' | 'relays' | 'sensor_values'> {
  return {
    link: linkOf(wish.link),
    ...(wish.relays.length === 0 ? {} : { relays: wish.relays }),
    ...(wish.sensorValues.length === 0 ? {} : { sensor_values: wish.sensorValues.map(sensorOf) }),
  };
}

type ScenarioJob = Omit<Job, 'scenario'> & { scenario: Scenario };

/** With all that is wished for it; `times` are taken over from the job before. */
export function jobOfTry(scenario: Scenario, wish: Wish, times: Job['times']): ScenarioJob {
  const faults = wish.more.flatMap(faultsOf);
  return {
    protocol: 'talkrobots', scenario, task_seconds: wish.taskSeconds, seed: within(wish).seed, ...surroundingsOf(wish), ...(faults.length === 0 ? {} : { faults }),
    ...(times === undefined ? {} : { times }), ...(wish.beside.length === 0 ? {} : { beside: wish.beside.map(besideOf) }),
  };
}

/** The wish that a job came from: all of its faults are in the list. */
export function wishOf(job: Job): Wish {
  const { protocol = 'paper', robots = FIRST.robots, tasks = FIRST.tasks, task_seconds: taskSeconds = FIRST.taskSeconds } = job;
  return {
    ...FIRST, protocol, robots, tasks, taskSeconds, faults: job.faulty ?? 0, more: wishesOf(job.faults ?? []), link: linkWishOf(job.link),
    relays: job.relays ?? [], sensorValues: (job.sensor_values ?? []).map(sensorWishOf), seed: job.seed ?? FIRST.seed,
    beside: (job.beside ?? []).map(besideWishOf), interpreted: job.interpreted ?? 0, sensors: job.sensors ?? 0,
  };
}

/** The nodes of a fleet that has no names of its own. */
export const countedNodes = (robots: number): string[] => ['cloud', ...Array.from({ length: robots }, (_, i) => `r${i}`)];

/** A scenario that is drawn, over Wi-Fi. One seed: what another drawing changes is the drawing's. */
export function jobOfScenario(scenario: Scenario): ScenarioJob {
  return { protocol: 'talkrobots', scenario, link: linkOf(FIRST.link), seed: FIRST.seed };
}

/** Robot 1, 2 ... in the middle of its first task: robot 0 has begun the run, and goes on. */
export function slidFaults(wish: Wish): JobFault[] {
  return Array.from({ length: wish.faults }, (_, i) => i + 1).flatMap((robot): JobFault[] => {
    const node = `r${robot}`;
    const at = (Math.min(robot, wish.tasks - 1) + 0.5) * wish.taskSeconds;
    if (wish.faultKind === 'fail') return [{ at, kind: 'fail', node }];
    const back = wish.faultKind === 'cut' ? 'heal' : 'start';
    return [{ at, kind: wish.faultKind, node }, { at: at + AWAY_S, kind: back, node }];
  });
}

/** So many things go wrong. */
export function faultCount(job: Job): number {
  return job.faulty ?? job.faults?.filter((fault) => WISHED_KINDS.includes(fault.kind as WishedKind)).length ?? 0;
}

export function isOver(one: Simulation): boolean {
  return one.state !== 'queued' && one.state !== 'running';
}
