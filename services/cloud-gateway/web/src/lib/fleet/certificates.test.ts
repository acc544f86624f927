import { expect, it } from 'vitest';
import type { NodeContent, Row } from '../api/types';
import { daysUntil, endingCertificates } from './certificates';

const NOW = Date.parse('2026-06-01T12:00:00.000Z');
const row = (node: string, ends: string) => ({ node, content: { certificate_ends: ends } }) as Row<NodeContent>;
const nodes = (rows: Row<NodeContent>[]) => endingCertificates(rows, NOW).map((one) => one.node);

it('names what ends within thirty days, or ended within the last thirty, the soonest first', () => {
  const rows = [
    row('later', '2026-07-02T12:00:00.000Z'), row('soon', '2026-06-30T00:00:00.000Z'), row('next', '2026-06-02T00:00:00.000Z'),
    row('ended', '2026-05-20T00:00:00.000Z'), row('forgotten', '2026-04-01T00:00:00.000Z'),
  ];
  expect(nodes(rows)).toEqual(['ended', 'next', 'soon']);
});

it('says nothing of a certificate that it does not know', () => {
  expect(nodes([row('new', '')])).toEqual([]);
});

it('counts whole days', () => {
  expect(daysUntil(NOW + 36 * 3600 * 1000, NOW)).toBe(1);
  expect(daysUntil(NOW + 3600 * 1000, NOW)).toBe(0);
  expect(daysUntil(NOW - 3600 * 1000, NOW)).toBe(-1);
});
