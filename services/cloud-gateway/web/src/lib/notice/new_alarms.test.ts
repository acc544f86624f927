import { expect, it } from 'vitest';
import type { Alert, AlertRow } from '../api/types';
import { loudest, NewAlarms, tonesOf } from './new_alarms';

const alert = (id: string, chatters = false, priority = 3) => ({ content: { id }, alarm: { chatters, priority } }) as AlertRow;
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

it('tells one that gets worse, once, also one that was there or that chatters; not one that gets better', () => {
  const news = new NewAlarms();
  news.see([alert('old')], true);
  news.see([alert('old'), alert('again', true)], true);
  expect(ids(news.see([alert('old', false, 2), alert('again', true, 1)], true))).toEqual(['old', 'again']);
  expect(ids(news.see([alert('old', false, 2), alert('again', true, 1)], true))).toEqual([]);
  expect(ids(news.see([alert('old', false, 3)], true))).toEqual([]);
  expect(ids(news.see([alert('old', false, 2)], true))).toEqual([]);
});

it('sounds as the worst of what is new, wherever it stands', () => {
  expect(loudest([{ severity: 'URGENT' }, { severity: 'CRITICAL' }] as Alert[])).toBe('CRITICAL');
  expect(loudest([])).toBeNull();
});

it('sounds the more the higher the priority', () => {
  expect(['WARNING', 'URGENT', 'CRITICAL'].map((one) => tonesOf(one as Alert['severity']).length)).toEqual([1, 2, 3]);
});
