import { describe, expect, it } from 'vitest';
import { newSensor, placeOfSensor, sensorOf, sensorsWanted, sensorWishOf, withWanted, wrongsOfSensor, type SensorWish } from './sensor_wish';

const wish = (more: Partial<SensorWish>, texts: Partial<SensorWish['texts']> = {}): SensorWish =>
  ({ ...newSensor('belt'), name: 'load', ...more, texts: { ...newSensor('belt').texts, ...texts } });
const NODES = ['cloud', 'belt'];

describe('a wished sensor', () => {
  it('is there for each condition, once', () => {
    const when = { sensor: 'temperature', of: 'belt', op: '>', value: 20, unit: 'degC' };
    const wanted = sensorsWanted({ name: 'n', tasks: [{ id: 'a', when }, { id: 'b', when: { ...when, op: '<=' } }, { id: 'c' }, { id: 'd', when: { sensor: 'door', value: 'open' } }] });
    expect(wanted.map((one) => [one.node, one.name, one.unit, one.texts.value])).toEqual([['belt', 'temperature', 'degC', '20'], ['cloud', 'door', '', 'open']]);
  });

  it('is added for another scenario, unless it is there', () => {
    const scenario = { name: 'n', tasks: [{ id: 'a', when: { sensor: 'load', of: 'belt' } }, { id: 'b', when: { sensor: 'door' } }] };
    expect(withWanted([wish({})], scenario).map((one) => [one.node, one.name])).toEqual([['belt', 'load'], ['cloud', 'door']]);
  });

  it('tells one value, steps, or a ramp', () => {
    expect(sensorOf(wish({ unit: 'kg' }, { value: '20,5' }))).toEqual({ node: 'belt', name: 'load', unit: 'kg', value: 20.5 });
    expect(sensorOf(wish({}, { value: 'open' })).value).toBe('open');
    expect(sensorOf(wish({}, { value: '-' })).value).toBeNull();
    expect(sensorOf(wish({ course: 'steps' }, { steps: '0 -\n12 E2-07\n' })).steps).toEqual([{ at: 0, value: null }, { at: 12, value: 'E2-07' }]);
    expect(sensorOf(wish({ course: 'ramp' }, { from: '1', to: '2', end: '9' })).ramp).toEqual({ from: 1, to: 2, begin: 0, end: 9 });
  });

  it('keeps a text that looks like a number: it is what a condition is compared with', () => {
    for (const value of ['00123', '0x1F', '123', '-', '1e3', '"x"', '']) {
      const [wanted] = sensorsWanted({ name: 'n', tasks: [{ id: 'a', when: { sensor: 'tag', value } }] });
      expect(sensorOf(wanted!).value).toBe(value);
      const job = sensorOf(wish({ course: 'steps' }, {}));
      const steps = [{ at: 0, value }, { at: 4, value: 7 }];
      expect(sensorOf(sensorWishOf({ ...job, steps })).steps).toEqual(steps);
    }
    for (const [text, value] of [['00123', '00123'], ['"7"', '7'], ['7', 7], ['-1,5', -1.5], ['.5', 0.5]] as const) {
      expect(sensorOf(wish({}, { value: text })).value).toBe(value);
    }
  });

  it('comes back from a job as it was', () => {
    for (const one of [wish({}, { value: '3' }), wish({ course: 'steps' }, { steps: '0 -\n4 x' }), wish({ course: 'ramp' }, { from: '1', to: '2', begin: '3', end: '4' })]) {
      expect(sensorOf(sensorWishOf(sensorOf(one)))).toEqual(sensorOf(one));
    }
  });

  it('says by its field what is wrong', () => {
    expect(wrongsOfSensor(wish({}, { value: '1' }), NODES, [])).toEqual({});
    expect(wrongsOfSensor(wish({ node: 'x', name: '2 hot' }), NODES, [])).toEqual({ node: { why: 'node' }, name: { why: 'name' }, value: { why: 'missing' } });
    expect(wrongsOfSensor(wish({}, { value: '1' }), NODES, [wish({})])).toEqual({ name: { why: 'twice' } });
    for (const steps of ['', '5', '3 1\n3 2', 'x 1']) expect(wrongsOfSensor(wish({ course: 'steps' }, { steps }), NODES, [])).toEqual({ steps: { why: 'steps' } });
    expect(wrongsOfSensor(wish({ course: 'ramp' }, { from: '1', to: '2', begin: '5', end: '5' }), NODES, [])).toEqual({ end: { why: 'end' } });
    expect(placeOfSensor('/sensor_values/2/ramp/end')).toEqual({ wish: 2, field: 'end' });
    expect(placeOfSensor('/sensor_values/0/steps/1/at')).toEqual({ wish: 0, field: 'steps' });
    expect(placeOfSensor('/faults/0')).toBeNull();
  });
});
