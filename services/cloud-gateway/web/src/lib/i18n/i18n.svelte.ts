/** The words of the chosen language: t('hall.title'), t('common.shown', {shown: 3, all: 9}). */
import { en, type Key, type Words } from './en';
import { fr } from './fr';

export type Language = 'en' | 'fr';
export const languages: Record<Language, { name: string; words: Words }> = {
  en: { name: 'English', words: en },
  fr: { name: 'Français', words: fr },
};

const KEPT = 'trb.language';

function first(): Language {
  const kept = localStorage.getItem(KEPT);
  if (kept === 'en' || kept === 'fr') return kept;
  return navigator.language.startsWith('fr') ? 'fr' : 'en';
}

class Speech {
  language = $state<Language>(first());

  choose(language: Language): void {
    this.language = language;
    localStorage.setItem(KEPT, language);
    document.documentElement.lang = language;
  }
}

export const speech = new Speech();

export function t(key: Key, values: Record<string, string | number> = {}): string {
  const [section, word] = key.split('.') as [keyof Words, string];
  const text = (languages[speech.language].words[section] as Record<string, string>)[word] ?? key;
  return text.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
}

/** A key that a view makes from data; the word itself if there is none. */
export function tOr(section: keyof Words, word: string): string {
  return (languages[speech.language].words[section] as Record<string, string>)[word] ?? word;
}

const formats = new Map<string, Intl.NumberFormat>(); // to make one takes far longer than to use it

export function formatNumber(value: number, digits = 2): string {
  return formatOf(`${digits}`, { maximumFractionDigits: digits }).format(value);
}

/** Of a sensor or a robot, in SI units: of less than one the first three figures, as 0.0004 A are no 0 A. */
export function formatReading(value: number): string {
  const size = Math.abs(value);
  if (size === 0 || size >= 1) return formatNumber(value, 3);
  return size >= 1e-6
    ? formatOf('small', { maximumSignificantDigits: 3 }).format(value)
    : formatOf('tiny', { maximumSignificantDigits: 3, notation: 'scientific' }).format(value);
}

function formatOf(name: string, options: Intl.NumberFormatOptions): Intl.NumberFormat {
  const key = `${speech.language} ${name}`;
  const format = formats.get(key) ?? new Intl.NumberFormat(speech.language, options);
  formats.set(key, format);
  return format;
}

/** 4 s, 12 min, 3 h. */
export function formatAge(seconds: number): string {
  if (seconds < 60) return `${Math.round(seconds)} s`;
  if (seconds < 3600) return `${Math.round(seconds / 60)} min`;
  return `${Math.round(seconds / 3600)} h`;
}

export function formatDate(ms: number): string {
  return new Date(ms).toLocaleDateString(speech.language);
}

/** The hour of the day, 24 h: 00:30:00 half an hour after midnight. */
export function formatHour(date: Date): string {
  return date.toLocaleTimeString(speech.language, { hourCycle: 'h23' }); // hour12: false is 24:30:00 in English
}

/** The hour of the day, 24 h; with the date if it was another day. UTC ns, or ISO 8601. */
export function formatTime(time: number | string): string {
  const date = new Date(typeof time === 'number' ? time / 1e6 : time);
  if (Number.isNaN(date.getTime())) return '';
  const hour = formatHour(date);
  const isToday = date.toDateString() === new Date().toDateString();
  return isToday ? hour : `${date.toLocaleDateString(speech.language)} ${hour}`;
}
