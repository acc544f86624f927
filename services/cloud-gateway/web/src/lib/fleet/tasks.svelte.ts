/** What each robot does at the moment, from the runs under way. */
import type { RunDetail, RunSummary } from '../api/types';
import { live, rowsOf } from '../live/live.svelte';

export interface RobotTask {
  run: string;
  runName: string;
  task: string;
  state: string;
}

const MOST_RUNS = 32; // a client may have 64 topics
const UNDER_WAY = ['RUNNING', 'PAUSED', 'ABORTING'];
const AT_WORK = ['RUNNING', 'INITIALIZING', 'PAUSED'];

/** The tasks of robots, by robot. Call it while a component is made; it needs the topic `fleet`. */
export function useTasks(): { readonly byRobot: Map<string, RobotTask> } {
  const runs = $derived(
    rowsOf<RunSummary>(live.rows('fleet'), 'run')
      .filter((row) => UNDER_WAY.includes(row.content.state))
      .map((row) => row.name)
      .slice(0, MOST_RUNS)
      .join(' '),
  );
  const topics = $derived(runs === '' ? [] : runs.split(' ').map((run) => `run/${run}`));

  $effect(() => {
    const ends = topics.map((topic) => live.use(topic));
    return () => ends.forEach((end) => end());
  });

  const byRobot = $derived(tasksOf(topics.flatMap((topic) => rowsOf<RunDetail>(live.rows(topic), 'run_detail'))));
  return {
    get byRobot() {
      return byRobot;
    },
  };
}

function tasksOf(details: { content: RunDetail }[]): Map<string, RobotTask> {
  const out = new Map<string, RobotTask>();
  for (const { content: run } of details) {
    for (const task of run.tasks) {
      if (!AT_WORK.includes(task.state)) continue;
      out.set(task.robot, { run: run.run, runName: run.name, task: task.id, state: task.state });
    }
  }
  return out;
}
