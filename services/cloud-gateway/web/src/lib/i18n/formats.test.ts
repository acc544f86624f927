import { beforeAll, describe, expect, it, vi } from 'vitest';

let speech: typeof import('./i18n.svelte');

beforeAll(async () => {
  vi.stubGlobal('localStorage', { getItem: () => 'en', setItem: () => undefined });
  vi.stubGlobal('document', { documentElement: {} });
  speech = await import('./i18n.svelte');
});

it.each([
  [['en-GB', 'en'], '28/11/2027'],
  [['en-US'], '11/28/2027'],
  [['de-DE', 'en-US', 'en'], '11/28/2027'],
  [['de-DE'], '28/11/2027'], // whose day comes first, too
])('writes a date as a browser of %j does, in the chosen language', (languages, date) => {
  vi.stubGlobal('navigator', { languages });
  speech.speech.choose('en');
  expect(speech.formatDate(new Date(2027, 10, 28).getTime())).toBe(date);
  expect(speech.formatTime(new Date(2027, 10, 28, 9, 5).toISOString())).toBe(`${date} 09:05:00`);
  speech.speech.choose('fr');
  expect(speech.formatDate(new Date(2027, 10, 28).getTime())).toBe('28/11/2027');
});

it('writes an age in days from the second one on', () => {
  speech.speech.choose('en');
  expect([59, 3599, 47 * 3600, 48 * 3600, 226 * 3600].map(speech.formatAge)).toEqual(['59 s', '60 min', '47 h', '2 d', '9 d']);
  speech.speech.choose('fr');
  expect(speech.formatAge(226 * 3600)).toBe('9 j');
});

it('names the zone of its times', () => {
  const at = (minutes: number) => speech.zoneOf({ getTimezoneOffset: () => minutes } as Date).split(', ')[1];
  expect([0, -60, 210, -330].map(at)).toEqual(['UTC+0', 'UTC+1', 'UTC−3:30', 'UTC+5:30']);
});

it('says one of a thing as one', async () => {
  await import('./late_words');
  speech.speech.choose('en');
  expect([1, 0, 2].map((robots) => speech.t('plan.fleet', { robots, tasks: 1 }))).toEqual(['1 robot, 1 task', '0 robots, 1 task', '2 robots, 1 task']);
  speech.speech.choose('fr');
  expect([1, 0, 2].map((robots) => speech.t('plan.fleet', { robots, tasks: 3 }))).toEqual(['1 robot, 3 tâches', '0 robot, 3 tâches', '2 robots, 3 tâches']);
});

it('lets no line of French begin with a sign, nor end with an opening quote', async () => {
  const { languages } = speech;
  await import('./late_words');
  const texts = Object.values(languages.fr.words).flatMap((words) => Object.values(words) as string[]);
  expect(texts.filter((text) => / [:;!?»%]|« /.test(text))).toEqual([]);
  expect(speech.frenchSpaces('Ouvertes : {count}, « {name} » ; 3 %')).toBe('Ouvertes\u00a0: {count}, «\u00a0{name}\u00a0»\u00a0; 3\u00a0%');
});

describe.each(['en', 'fr'] as const)('%s', (language) => {
  beforeAll(() => speech.speech.choose(language));

  it('writes the first hour of a day as 00', () => {
    const at = new Date(2026, 0, 31, 0, 30, 5);
    expect(speech.formatHour(at)).toBe('00:30:05');
    expect(speech.formatTime(at.getTime() * 1e6)).toMatch(/2026 00:30:05$/);
  });

  it('writes a time within a text as each other time of the view', () => {
    const at = new Date();
    at.setHours(10, 47, 19, 809);
    const text = `'mobile' is broken since ${at.toISOString()}: both wheels`;
    expect(speech.localTimes(text)).toBe("'mobile' is broken since 10:47:19: both wheels");
    expect(speech.localTimes('from 2026-01-31T12:00:00Z to 2026-01-31T12:30:00.5Z')).toMatch(/^from .*2026 \d\d:00:00 to .*2026 \d\d:30:00$/);
    expect(speech.localTimes('box 2026-01-31, 2026-99-99T99:99:99Z')).toBe('box 2026-01-31, 2026-99-99T99:99:99Z');
  });

  it('writes what is less than one with its first figures', () => {
    const point = language === 'en' ? '.' : ',';
    const shown = [0.0004, 0.00012345, -0.0123456, 0.5, 0, 1.23456, -21.5].map(speech.formatReading);
    expect(shown.map((one) => one.replace(point, '.'))).toEqual(['0.0004', '0.000123', '-0.0123', '0.5', '0', '1.235', '-21.5']);
    expect(speech.formatReading(3.2e-9).replace(point, '.')).toBe('3.2E-9');
  });
});
