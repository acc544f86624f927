import { describe, expect, it } from 'vitest';
import type { RobotContent, Row, RunDetail, TaskView } from '../api/types';
import { helpOf, runBadge, runOrders, shortId, taskOrders, taskWord } from './run_state';

const run = (state: RunDetail['state'], paused_by = '') => ({ state, paused_by }) as RunDetail;
const task = (state: TaskView['state']) => ({ state }) as TaskView;

describe('what may be ordered', () => {
  it('pauses what runs, and resumes what a person holds', () => {
    expect(runOrders(run('RUNNING'))).toEqual(['pause', 'abort']);
    expect(runOrders(run('PAUSED', 'olga'))).toEqual(['resume', 'abort']);
  });

  it('resumes nothing that waits for an alert: nobody has paused it', () => {
    expect(runOrders(run('PAUSED'))).toEqual(['pause', 'abort']);
  });

  it('calls paused only what a person holds', () => {
    expect(runBadge({ state: 'PAUSED', waits_for: "task 'a' failed on 'ur3': no part" }).word).toBe('waits');
    expect(runBadge({ state: 'PAUSED', waits_for: "a person: held by 'cloud': lunch" }).word).toBe('PAUSED');
    expect(runBadge({ state: 'PAUSED', waits_for: "'ur3' is silent", paused_by: 'cloud' }).word).toBe('PAUSED');
    expect(runBadge({ state: 'RUNNING', waits_for: 'the robot is busy' }).word).toBe('RUNNING');
  });

  it('offers what helps a run that waits: its failed tasks, its stopped robots', () => {
    const tasks = [{ id: 'a', robot: 'ur3', state: 'FAILED' }, { id: 'b', robot: 'drone', state: 'WAITING' }, { id: 'c', robot: 'kuka', state: 'FINISHED' }];
    const robots = ['drone', 'kuka', 'abb'].map((node) => ({ node, content: { fenced: true } }) as Row<RobotContent>);
    expect(helpOf({ state: 'PAUSED', tasks } as RunDetail, robots)).toEqual({ tasks: ['a'], stopped: ['drone'] });
    expect(helpOf({ state: 'ABORTED', tasks } as RunDetail, robots)).toEqual({ tasks: [], stopped: [] });
  });

  it('orders nothing of a run that is over', () => {
    for (const state of ['FINISHED', 'ABORTED', 'EXPIRED'] as const) {
      expect(runOrders(run(state))).toEqual([]);
      expect(taskOrders(run(state), task('FAILED'))).toEqual([]);
    }
  });

  it('tries again only what has failed', () => {
    expect(taskOrders(run('RUNNING'), task('FAILED'))).toContain('retry');
    expect(taskOrders(run('RUNNING'), task('WAITING'))).toEqual(['move', 'skip']);
    expect(taskOrders(run('RUNNING'), task('FINISHED'))).toEqual([]);
  });

  it('names what was interrupted so: nobody repeats it but a person', () => {
    expect(taskWord('RETRIABLE', 'interrupted')).toBe('interrupted');
    expect(taskWord('RETRIABLE', 'retriable')).toBe('RETRIABLE');
    expect(taskWord('FINISHED', 'finished')).toBe('FINISHED');
  });

  it('waits for nothing once its run is over', () => {
    expect(taskWord('WAITING', 'none', 'ABORTED')).toBe('notBegun');
    expect(taskWord('INITIALIZING', 'none', 'EXPIRED')).toBe('notBegun');
    expect(taskWord('WAITING', 'none', 'PAUSED')).toBe('WAITING');
    expect(taskWord('FAILED', 'failed', 'ABORTED')).toBe('FAILED');
  });

  it('shortens an id', () => expect(shortId('60cd4110aa55')).toBe('60cd4110'));
});
