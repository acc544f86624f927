import { describe, expect, it } from 'vitest';
import { LiveCore, SIGNED_OUT, type Frame } from './core';

const INSTANCE = '17239847298374982731'; // more bits than a number of JavaScript has

function robot(node: string, number: number, fenced = false) {
  return {
    kind: 'robot', node, name: '', number, version: number, live: 'live', heard: '2026-01-01T00:00:00.000Z',
    content: { fenced },
  };
}

function gone(node: string, number: number) {
  return { kind: 'robot', node, name: '', number, removed: true };
}

function frame(head: number, ...blocks: Partial<Frame['blocks'][number]>[]): string {
  const whole = blocks.map((block) => ({
    topic: 'fleet', begins: false, snapshot: false, more: false, to: head, rows: [], ...block,
  }));
  const text = JSON.stringify({ count: 1, head, instance: 0, time: '', notices: [], left_out: 0, messages: [], blocks: whole });
  return text.replace('"instance":0', `"instance":${INSTANCE}`);
}

function snapshot(...rows: unknown[]) {
  return { begins: true, snapshot: true, rows: rows as never[] };
}

function delta(...rows: unknown[]) {
  return { rows: rows as never[] };
}

/** A page that shows the fleet, connected at time 0. */
function openPage(): LiveCore {
  const core = new LiveCore();
  core.use('fleet');
  expect(core.start(0).connect).toBe(true);
  expect(core.opened(0).send).toEqual(['{"subscribe":"fleet"}']);
  return core;
}

const ids = (core: LiveCore) => [...core.rows('fleet').values()].map((row) => row.node);

it('tells that another gateway speaks before its first messages', () => {
  const core = openPage();
  const told: unknown[] = [];
  core.onOther = () => told.push('other');
  core.onMessages = (messages) => told.push(...messages);
  const passed = (number: number, instance: string) => {
    const one = { ...(JSON.parse(frame(1)) as Frame), messages: [number] };
    return JSON.stringify(one).replace(/"instance":\d+/, `"instance":${instance}`);
  };
  core.heard(passed(900, INSTANCE), 10);
  core.heard(passed(901, INSTANCE), 20);
  core.closed(1006, 30);
  core.tick(300);
  core.opened(310);
  core.heard(passed(1, INSTANCE.replace(/1$/, '2')), 320);
  expect(told).toEqual([900, 901, 'other', 1]);
});

describe('rows', () => {
  it('shows a snapshot once it is whole', () => {
    const core = openPage();
    core.heard(frame(5, { ...snapshot(robot('ur3', 4)), more: true }), 10);
    expect(ids(core)).toEqual([]);
    core.heard(frame(5, { snapshot: true, rows: [robot('drone', 5)] as never[] }), 20);
    expect(ids(core)).toEqual(['ur3', 'drone']);
    expect(core.isKnown('fleet')).toBe(true);
  });

  it('applies changes and removals', () => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4), robot('drone', 5))), 10);
    core.heard(frame(7, delta(robot('ur3', 6, true), gone('drone', 7))), 20);
    expect([...core.rows('fleet').values()].map((row) => row.content)).toEqual([{ fenced: true }]);
  });

  it('makes changed rows another Map, as Svelte tells a derived value to nobody while it is the same object', () => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4))), 10);
    const before = core.rows('fleet');
    core.heard(frame(5), 20);
    expect(core.rows('fleet')).toBe(before);
    core.heard(frame(6, delta(robot('ur3', 6, true))), 30);
    expect(core.rows('fleet')).not.toBe(before);
    expect([...before.values()].map((row) => row.number)).toEqual([4]);
  });

  it('keeps the old rows until a new snapshot is whole, and drops what it lacks', () => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4), robot('drone', 5))), 10);
    core.heard(frame(9, { ...snapshot(robot('ur3', 8)), more: true }), 20);
    expect(ids(core)).toEqual(['ur3', 'drone']);
    core.heard(frame(9, { snapshot: true, rows: [] }), 30);
    expect(ids(core)).toEqual(['ur3']);
  });

  it('ignores a block of a topic that was left a moment ago', () => {
    const core = openPage();
    core.leave('fleet');
    core.heard(frame(5, snapshot(robot('ur3', 4))), 10);
    expect(ids(core)).toEqual([]);
  });
});

describe('who tells nothing', () => {
  const silent = (text: string, ...sources: string[]) => text.replace('"time":""', `"time":"","silent":${JSON.stringify(sources)}`);
  const alerts = { ...snapshot(), topic: 'alerts' };

  it('makes no empty list a known one: before the first table nobody knows whether there was an alert', () => {
    const core = new LiveCore();
    core.use('alerts');
    core.start(0);
    core.opened(0);
    core.heard(silent(frame(5, alerts), 'scheduler', 'resilience'), 10);
    expect(core.isKnown('alerts')).toBe(false);
    expect(core.isSilent('resilience')).toBe(true);
    core.heard(silent(frame(5), 'scheduler'), 1010);
    expect(core.isKnown('alerts')).toBe(true);
    expect(core.isSilent('resilience')).toBe(false);
    core.heard(silent(frame(5), 'resilience'), 2010);
    expect(core.isKnown('alerts')).toBe(false);
  });

  it('is told for the rows of each service: runs are in the topic of the fleet, too', () => {
    const core = openPage();
    core.use('run/1');
    core.heard(silent(frame(5, snapshot(robot('ur3', 4)), { ...snapshot(), topic: 'run/1' }), 'scheduler'), 10);
    expect(core.isKnown('fleet')).toBe(true);
    expect(core.isKnown('run/1')).toBe(false);
    expect(core.isSilent('scheduler')).toBe(true);
  });

  it('is nobody with a gateway that does not say it, and after a sign-out', () => {
    const core = openPage();
    core.heard(silent(frame(5, snapshot(robot('ur3', 4))), 'router'), 10);
    expect(core.isKnown('fleet')).toBe(false);
    core.heard(frame(6), 20);
    expect(core.isKnown('fleet')).toBe(true);
    core.heard(silent(frame(6), 'router'), 30);
    core.closed(SIGNED_OUT, 40);
    expect(core.isSilent('router')).toBe(false);
  });
});

describe('topics', () => {
  it('are subscribed by their first user and ended by their last one', () => {
    const core = openPage();
    expect(core.use('alerts').send).toEqual(['{"subscribe":"alerts"}']);
    expect(core.use('alerts').send).toEqual([]);
    expect(core.leave('alerts').send).toEqual([]);
    expect(core.leave('alerts').send).toEqual(['{"unsubscribe":"alerts"}']);
    expect(core.leave('alerts').send).toEqual([]);
  });
});

describe('a lost connection', () => {
  it('is noticed after 3 s without a frame', () => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4))), 1000);
    expect(core.tick(3900).close).toBeUndefined();
    expect(core.isLost).toBe(false);
    expect(core.tick(4000).close).toBe(true);
    expect(core.isLost).toBe(true);
  });

  it('keeps what it shows, and resumes at its number with every bit of the instance', () => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4))), 1000);
    core.closed(1006, 1100);
    expect(ids(core)).toEqual(['ur3']);
    expect(core.tick(1200).connect).toBeUndefined();
    expect(core.tick(1350).connect).toBe(true);
    expect(core.opened(1400).send).toEqual([`{"subscribe":"fleet","instance":${INSTANCE},"from":5}`]);
    core.heard(frame(6, delta(robot('drone', 6))), 1500);
    expect(ids(core)).toEqual(['ur3', 'drone']);
  });

  it('does not resume a topic of which it has no whole snapshot', () => {
    const core = openPage();
    core.heard(frame(5, { ...snapshot(robot('ur3', 4)), more: true }), 1000);
    core.closed(1006, 1100);
    core.tick(1350);
    expect(core.opened(1400).send).toEqual(['{"subscribe":"fleet"}']);
  });

  it.each(['closed', 'quiet'])('drops half a snapshot (%s): what comes after it is no whole one', (how) => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4), robot('drone', 5))), 1000);
    core.heard(frame(900, { ...snapshot(robot('ur3', 898)), more: true }), 1100);
    if (how === 'closed') core.closed(1006, 1200);
    else expect(core.tick(4100).close).toBe(true);
    expect(core.tick(4400).connect).toBe(true);
    expect(core.opened(4500).send).toEqual([`{"subscribe":"fleet","instance":${INSTANCE},"from":5}`]);
    core.heard(frame(901, delta(robot('kuka1', 901))), 4600);
    expect(ids(core)).toEqual(['ur3', 'drone', 'kuka1']);
  });

  it('tries again with longer waits, 1 s at most, for ever', () => {
    const core = openPage();
    const waits: number[] = [];
    for (let now = 0, i = 0; i < 6; ++i) {
      core.closed(1006, now);
      const from = now;
      while (core.tick(now).connect === undefined) now += 50;
      waits.push(now - from);
    }
    expect(waits).toEqual([250, 500, 1000, 1000, 1000, 1000]);
  });

  it('gives a connection 8 s to open after some that failed: the browser itself keeps it back', () => {
    const core = new LiveCore();
    core.start(0);
    let now = 0;
    for (let i = 0; i < 3; i++) {
      core.closed(1006, now);
      while (core.tick(now).connect === undefined) now += 50;
    }
    expect(core.tick(now + 7900).close).toBeUndefined();
    expect(core.tick(now + 8000).close).toBe(true);
  });

  it('gives a connection 3 s to open', () => {
    const core = new LiveCore();
    core.start(0);
    expect(core.tick(2900).close).toBeUndefined();
    expect(core.tick(3000).close).toBe(true);
    expect(core.tick(3250).connect).toBe(true);
  });

  it('starts anew when the gateway has', () => {
    const core = openPage();
    core.heard(frame(500, snapshot(robot('ur3', 4))), 1000);
    const restarted = JSON.parse(frame(3, snapshot(robot('drone', 2)))) as Frame;
    restarted.notices = [{ topic: 'fleet', kind: 'restarted' }];
    core.heard(JSON.stringify(restarted), 2000);
    expect(ids(core)).toEqual(['drone']);
  });

  it('is lost until the new one has told something: what is shown is of the one before', () => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4))), 10);
    core.closed(1006, 500);
    core.tick(800);
    core.opened(900);
    expect(core.isLost).toBe(true);
    core.heard(frame(6), 1000);
    expect(core.isLost).toBe(false);
    expect(ids(core)).toEqual(['ur3']);
  });
});

describe('the time', () => {
  const at = (time: string) => frame(5).replace('"time":""', `"time":"${time}"`);

  it("is the gateway's, whatever the browser's clock says, also while the connection is lost", () => {
    const core = openPage();
    expect(core.utcAt(900)).toBeNull();
    core.heard(at('2026-01-01T00:00:10.000Z'), 1000);
    expect(core.utcAt(1500)).toBe(Date.parse('2026-01-01T00:00:10.500Z'));
    core.closed(1006, 1600);
    expect(core.utcAt(3000)).toBe(Date.parse('2026-01-01T00:00:12.000Z'));
  });

  it("follows the gateway's clock when that is set, and ignores what is no time", () => {
    const core = openPage();
    core.heard(at('2026-01-01T00:00:10.000Z'), 1000);
    core.heard(at('2025-12-31T23:00:11.000Z'), 2000);
    core.heard(at('soon'), 3000);
    expect(core.utcAt(3000)).toBe(Date.parse('2025-12-31T23:00:12.000Z'));
  });
});

describe('a sign-out', () => {
  it('forgets everything and does not connect again', () => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4))), 1000);
    core.closed(SIGNED_OUT, 1100);
    expect(core.phase).toBe('off');
    expect(ids(core)).toEqual([]);
    expect(core.tick(9000)).toEqual({ send: [] });
  });
});

describe('a refused word', () => {
  const refusal = '{"error":{"detail":"topic: 256 sensors are watched"}}';

  it('is told, and changes no row', () => {
    const core = openPage();
    core.heard(refusal, 10);
    expect(core.refused).toBe('topic: 256 sensors are watched');
    expect(core.heardAt).toBeNull();
  });

  it('stays shown while a topic waits that it may be of, and goes with its block', () => {
    const core = openPage();
    core.use('sensor/ur3/dht22');
    core.use('messages'); // has no block
    core.heard(refusal, 10);
    core.heard(frame(5, snapshot(robot('ur3', 4))), 20);
    core.heard(frame(6, delta(robot('ur3', 5))), 30);
    expect(core.refused).not.toBe('');
    core.heard(frame(6, { ...snapshot(), topic: 'sensor/ur3/dht22' }), 40);
    expect(core.refused).toBe('');
  });

  it('goes with the view that has asked for it', () => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4))), 10);
    core.use('sensor/ur3/dht22');
    core.heard(refusal, 20);
    core.leave('sensor/ur3/dht22');
    expect(core.refused).toBe('');
  });

  it('of a drive goes with the next answer to one', () => {
    const core = openPage();
    core.heard(frame(5, snapshot(robot('ur3', 4))), 10);
    core.heard(refusal, 20);
    core.heard(frame(6, delta(robot('ur3', 6))), 30);
    expect(core.refused).not.toBe('');
    core.heard('{"drive":{"robot":"ur3","sequence":4,"state":"driving","round_trip_s":0.01}}', 40);
    expect(core.refused).toBe('');
  });

  it('goes with the connection, and with a sign-out', () => {
    const core = openPage();
    core.heard(refusal, 10);
    core.closed(1006, 20);
    core.tick(300);
    core.opened(310);
    expect(core.refused).toBe('');
    core.heard(refusal, 320);
    core.closed(SIGNED_OUT, 330);
    expect(core.refused).toBe('');
  });
});

describe('news of a drive', () => {
  it('is told, is no frame, and changes no row', () => {
    const core = openPage();
    const told: unknown[] = [];
    core.onDrive = (answer) => told.push(answer);
    core.heard('{"drive":{"robot":"ur3","sequence":4,"state":"driving","round_trip_s":0.01}}', 10);
    expect(told).toEqual([{ robot: 'ur3', sequence: 4, state: 'driving', round_trip_s: 0.01 }]);
    expect(core.heardAt).toBeNull();
  });
});
