import { expect, it } from 'vitest';
import { criteriaOf, formOfPolicy, minimumsOf, numberOf, policyOf, rowsOfCriteria, rowsOfMinimums, twice, unitOf, withNewBounds, withNewCriteria, withUnit, type Criteria } from './settings';

const criteria = {
  criteria: {
    battery: { weight: 0.25, best: 100, worst: 0, at_least: 20 },
    distance: { weight: 0, best: 0, worst: 100 },
    payload: { weight: 0.75, best: 10, worst: 0, from: 'description', value: 'payload', unit: 'kg', capabilities: ['grab'] },
  },
} as unknown as Criteria;

it('sends back what it has read', () => {
  expect(criteriaOf(rowsOfCriteria(criteria))).toEqual(criteria);
  const policy = { mode: 'automatic', bind: 'ask', max_moves: 3, expires_s: 60, conditions: { min_score: 0.5, min_lead: 0, max_severity: 'URGENT' } } as const;
  expect(policyOf(formOfPolicy(policy))).toEqual(policy);
  const minimums = { battery: { at_least: 20 } };
  expect(minimumsOf(rowsOfMinimums(criteria, minimums))).toEqual(minimums);
});

it('shows a share without the tail of a binary fraction', () => {
  const third = rowsOfCriteria({ criteria: { battery: { weight: 1 / 3 } } } as unknown as Criteria)[0];
  expect(third?.weight).toBe('0.333333');
});

it('takes a comma, and leaves what is no number for the gateway to refuse', () => {
  expect([numberOf(' 0,5 '), numberOf(''), numberOf('much'), numberOf('1e999')]).toEqual([0.5, undefined, 'much', '1e999']);
});

it('sends no bound for a field that is empty', () => {
  const rows = rowsOfMinimums(criteria, {});
  rows[1]!.atMost = '40';
  expect(minimumsOf(rows)).toEqual({ distance: { at_most: 40 } });
  expect(rows.map((row) => row.unit)).toEqual(['%', 'm', 'kg']);
});

it('finds a name that is there twice', () => {
  const rows = rowsOfCriteria(criteria);
  expect(twice(rows)).toBeNull();
  rows[2]!.name = 'battery ';
  expect(twice(rows)).toBe('battery');
});

it('keeps what is typed when bounds or criteria were saved in the other form', () => {
  const bounded = { criteria: { ...criteria.criteria, distance: { weight: 0, best: 0, worst: 100, at_most: 40 } } } as unknown as Criteria;
  const typed = rowsOfCriteria(criteria);
  expect(withNewBounds(typed, criteria, bounded)).toEqual(rowsOfCriteria(bounded));
  typed[0]!.weight = '0.77';
  const next = withNewBounds(typed, criteria, bounded)!;
  expect([next[0]!.weight, next[1]!.kept.at_most]).toEqual(['0.77', 40]);
  const others = { criteria: { ...criteria.criteria, distance: { weight: 1, best: 0, worst: 100 } } } as unknown as Criteria;
  expect(withNewBounds(typed, criteria, others)).toBeNull();
});

it('keeps typed minimums of criteria that are still there', () => {
  const old = rowsOfMinimums(criteria, {});
  const typed = rowsOfMinimums(criteria, {});
  typed[1]!.atMost = '40';
  const fewer = rowsOfMinimums({ criteria: { battery: { weight: 1 }, distance: { weight: 1 }, load: { weight: 1, unit: 'kg' } } } as unknown as Criteria, { battery: { at_least: 10 } });
  expect(withNewCriteria(typed, old, fewer)!.map((row) => [row.name, row.atLeast, row.atMost])).toEqual([['battery', '10', ''], ['distance', '', '40'], ['load', '', '']]);
  expect(withNewCriteria(typed, old, rowsOfMinimums(criteria, { distance: { at_most: 9 } }))).toBeNull();
});

it('names the unit of a best value', () => {
  expect(rowsOfCriteria(criteria).map((row) => withUnit('Best value', unitOf(row)))).toEqual(['Best value (%)', 'Best value (m)', 'Best value (kg)']);
});
