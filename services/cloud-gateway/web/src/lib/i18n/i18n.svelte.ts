/** The words of the chosen language: t('hall.title'), t('common.shown', {shown: 3, all: 9}). */
import { en, type Key, type Words } from './en';
import { fr } from './fr';

export type Language = 'en' | 'fr';

/** French has spaces where no line may be broken: before a sign of two parts, within quotes. */
export function frenchSpaces(text: string): string {
  return text.replace(/ (?=[:;!?»%])/g, '\u00a0').replace(/« /g, '«\u00a0');
}

/** The words of a language, as they are shown. */
export function asShown<Of extends object>(language: Language, words: Of): Of {
  if (language !== 'fr') return words;
  const spaced = (of: Record<string, string>) => Object.fromEntries(Object.entries(of).map(([key, text]) => [key, frenchSpaces(text)]));
  return Object.fromEntries(Object.entries(words).map(([section, of]) => [section, spaced(of as Record<string, string>)])) as Of;
}

export const languages: Record<Language, { name: string; words: Words }> = {
  en: { name: 'English', words: en },
  fr: { name: 'Français', words: asShown('fr', fr) },
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

/** `{tasks|task|tasks}` is the word for so many tasks: of one, of others. In French none has the word of one. */
function counted(text: string, values: Record<string, string | number>): string {
  const ones = speech.language === 'fr' ? ['0', '1'] : ['1'];
  return text.replace(/\{(\w+)\|([^|}]*)\|([^}]*)\}/g, (_, name: string, one: string, others: string) => (ones.includes(String(values[name])) ? one : others));
}

export function t(key: Key, values: Record<string, string | number> = {}): string {
  const [section, word] = key.split('.') as [keyof Words, string];
  const text = (languages[speech.language].words[section] as Record<string, string>)[word] ?? key;
  return counted(text, values).replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
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

/** 4 s, 12 min, 3 h, 5 d. */
export function formatAge(seconds: number): string {
  if (seconds < 60) return `${Math.round(seconds)} s`;
  if (seconds < 3600) return `${Math.round(seconds / 60)} min`;
  const hours = Math.round(seconds / 3600);
  return hours < 48 ? `${hours} h` : t('common.days', { days: Math.floor(seconds / 86400) });
}

/** Dates have the order of the browser's country, in the chosen language: 11/28 is no date in England. Without one the day comes first. */
function dateLocale(): string {
  const language = speech.language;
  const own = globalThis.navigator?.languages?.find((one) => one === language || one.startsWith(`${language}-`));
  return own ?? (language === 'en' ? 'en-GB' : language);
}

export function formatDate(ms: number): string {
  return new Date(ms).toLocaleDateString(dateLocale());
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
  return isToday ? hour : `${formatDate(date.getTime())} ${hour}`;
}

/** In which zone all times are: Europe/Paris, UTC+1. */
export function zoneOf(date: Date): string {
  const east = -date.getTimezoneOffset();
  const [hours, minutes] = [Math.floor(Math.abs(east) / 60), Math.abs(east) % 60];
  const offset = `UTC${east < 0 ? '−' : '+'}${hours}${minutes === 0 ? '' : `:${minutes}`}`;
  return `${new Intl.DateTimeFormat().resolvedOptions().timeZone}, ${offset}`;
}

/** A text of a robot or a service, with the times in it as all others of the view: they write them in UTC. */
export function localTimes(text: string): string {
  return text.replace(/\b\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z/g, (time) => formatTime(time) || time);
}
