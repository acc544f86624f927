import { expect, it } from 'vitest';
import type { Alert, AlertRow } from '../api/types';
import { NewAlarms, tonesOf } from './new_alarms';

const alert = (id: string, chatters = false) => ({ content: { id }, alarm: { chatters } }) as AlertRow;
const ids = (alerts: Alert[]) => alerts.map((one) => one.id);

it('tells each alarm once, and none that was there when the page was opened', () => {
  const news = new NewAlarms();
  expect(ids(news.see([], false))).toEqual([]);
  expect(ids(news.see([alert('old')], true))).toEqual([]);
  expect(ids(news.see([alert('old'), alert('new')], true))).toEqual(['new']);
  expect(ids(news.see([], true))).toEqual([]);
  expect(ids(news.see([alert('old'), alert('new')], true))).toEqual([]); // the stream was lost and came back
});

it('tells none that chatters, and none of those once its source has fallen quiet', () => {
  const news = new NewAlarms();
  news.see([], true);
  expect(ids(news.see([alert('again', true), alert('new')], true))).toEqual(['new']);
  expect(ids(news.see([alert('again'), alert('new')], true))).toEqual([]);
});

it('sounds the more the higher the priority', () => {
  expect(['WARNING', 'URGENT', 'CRITICAL'].map((one) => tonesOf(one as Alert['severity']).length)).toEqual([1, 2, 3]);
});
