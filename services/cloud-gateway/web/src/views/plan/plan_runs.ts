/** Runs that were simulated at the same time: each as an answer of its own, and what they cost each other. */
import type { Schemas } from '../../lib/api/types';
import type { Bar } from '../runs/timeline';
import { barsOf, makespanOf, type Answer } from './plan_result';

type Beside = Schemas['SimulationBeside'];
type Wait = Schemas['SimulationWait'];

export interface OneRun {
  /** From 1: the first one. */
  number: number;
  name: string;
  /** In s since the first one's; nothing: the simulation ended before. */
  submitted: number | null;
  /** Nothing: it is not finished. */
  makespan: number | null;
  alone: number | null;
  /** How long its tasks waited because another run kept their robot, and how many of them. */
  kept: { seconds: number; tasks: number };
  /** Of this run alone; its times count from the first run's submission, as all times of the view. */
  answer: Answer;
}

/** A hand-over is shorter. */
const COUNTED_S = 0.5;

/** Nothing of a simulation of one run. */
export function runsOf(answer: Answer): OneRun[] {
  const { beside, alone_s: alone = null, ...first } = answer;
  if (beside === undefined || answer.world === undefined) return [];
  const own = { number: 1, name: answer.world.scenario ?? '', submitted: 0, makespan: makespanOf(first), alone, kept: keptOf(first.waits), answer: first };
  return [own, ...beside.map((one, i) => besideRun(answer, one, i + 2))];
}

function besideRun(answer: Answer, one: Beside, number: number): OneRun {
  const own = answerOf(answer, one);
  const submitted = one.submitted_s === 0 ? null : one.submitted_s - answer.world!.submitted_s;
  return { number, name: one.scenario, submitted, makespan: makespanOf(own), alone: one.alone_s, kept: keptOf(one.waits), answer: own };
}

function answerOf(answer: Answer, one: Beside): Answer {
  const { tasks, tasks_not_listed, waits, scenario: _, after_s: __, alone_s: ___, ...end } = one;
  const { beside: ____, alone_s: _____, ...all } = answer;
  const { linked_s, events, submitted_s } = answer.world!;
  return { ...all, tasks, tasks_not_listed, waits, world: { ...end, linked_s, events, submitted_s } };
}

function keptOf(waits: Wait[] = []): OneRun['kept'] {
  const kept = waits.map((wait) => wait.kept_s ?? 0).filter((seconds) => seconds >= COUNTED_S);
  return { seconds: kept.reduce((sum, one) => sum + one, 0), tasks: kept.length };
}

/** A task of one of several runs. */
export const taskOfRun = (run: number, task: string): string => `${run}: ${task}`;

/** Of all its runs, by their begin; of several each task with its run's number. */
export function allBars(answer: Answer): Bar[] {
  const runs = runsOf(answer);
  if (runs.length === 0) return barsOf(answer);
  const bars = runs.flatMap((run) => barsOf(run.answer).map((bar) => ({ ...bar, task: taskOfRun(run.number, bar.task) })));
  return bars.sort((a, b) => (a.start ?? 0) - (b.start ?? 0));
}
