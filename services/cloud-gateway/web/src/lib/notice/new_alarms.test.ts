import { expect, it } from 'vitest';
import type { Alert } from '../api/types';
import { NewAlarms, tonesOf } from './new_alarms';

const alert = (id: string) => ({ id }) as Alert;
const ids = (alerts: Alert[]) => alerts.map((one) => one.id);

it('tells each alarm once, and none that was there when the page was opened', () => {
  const news = new NewAlarms();
  expect(ids(news.see([], false))).toEqual([]);
  expect(ids(news.see([alert('old')], true))).toEqual([]);
  expect(ids(news.see([alert('old'), alert('new')], true))).toEqual(['new']);
  expect(ids(news.see([], true))).toEqual([]);
  expect(ids(news.see([alert('old'), alert('new')], true))).toEqual([]); // the stream was lost and came back
});

it('sounds the more the higher the priority', () => {
  expect(['WARNING', 'URGENT', 'CRITICAL'].map((one) => tonesOf(one as Alert['severity']).length)).toEqual([1, 2, 3]);
});
