/** Numbers and texts as somebody types them. */

/** As a number is written. A tag's "00123" or "0x1F" is none. */
const NUMERAL = /^[-+]?(0|[1-9]\d*)?([.,]\d+)?([eE][-+]?\d+)?$/;

/** Also with a comma. Nothing: there is none, or it is none. */
export function numberIn(text: string | undefined): number | undefined {
  const trimmed = (text ?? '').trim().replace(',', '.');
  const value = trimmed === '' ? NaN : Number(trimmed);
  return Number.isFinite(value) ? value : undefined;
}

/** What is no number stays text: nobody's word is lost, and the check says what is wrong with it. */
export function numberOrText(text: string): number | string | undefined {
  return numberIn(text) ?? (text.trim() === '' ? undefined : text.trim());
}

/** What a sensor is compared with. What stands in quotes is a text, whatever it is. */
export function valueIn(text: string): number | string {
  const trimmed = text.trim();
  const quoted = /^"(.*)"$/s.exec(trimmed);
  if (quoted) return quoted[1]!;
  return (NUMERAL.test(trimmed) ? numberIn(trimmed) : undefined) ?? trimmed;
}

/** As `valueIn` reads it again. */
export function textIn(value: number | string): string {
  return value !== '' && valueIn(String(value)) === value ? String(value) : `"${value}"`;
}
