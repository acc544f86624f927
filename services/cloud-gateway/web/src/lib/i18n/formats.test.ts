import { beforeAll, describe, expect, it, vi } from 'vitest';

let speech: typeof import('./i18n.svelte');

beforeAll(async () => {
  vi.stubGlobal('localStorage', { getItem: () => 'en', setItem: () => undefined });
  vi.stubGlobal('document', { documentElement: {} });
  speech = await import('./i18n.svelte');
});

describe.each(['en', 'fr'] as const)('%s', (language) => {
  beforeAll(() => speech.speech.choose(language));

  it('writes the first hour of a day as 00', () => {
    const at = new Date(2026, 0, 31, 0, 30, 5);
    expect(speech.formatHour(at)).toBe('00:30:05');
    expect(speech.formatTime(at.getTime() * 1e6)).toMatch(/2026 00:30:05$/);
  });

  it('writes what is less than one with its first figures', () => {
    const point = language === 'en' ? '.' : ',';
    const shown = [0.0004, 0.00012345, -0.0123456, 0.5, 0, 1.23456, -21.5].map(speech.formatReading);
    expect(shown.map((one) => one.replace(point, '.'))).toEqual(['0.0004', '0.000123', '-0.0123', '0.5', '0', '1.235', '-21.5']);
    expect(speech.formatReading(3.2e-9).replace(point, '.')).toBe('3.2E-9');
  });
});
