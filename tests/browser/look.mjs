/** Looks at what is shown in each size and colour: pictures, axe, and that nothing lies beside a phone's screen. */
import { mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { require } from './person.mjs';

const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const SIZES = [[390, 844], [1280, 800], [2560, 1440]];
const THEMES = ['light', 'dark'];

/** `short`: on a phone in the dark and a desk in the light alone; `at`: what the pictures show, the top without it. */
export async function look(person, name, { short = person.settings.short, at } = {}) {
  const { page, settings } = person;
  const found = new Map(); // each once, with where it was found
  const shown = SIZES.flatMap(([width, height]) => THEMES.map((theme) => ({ width, height, theme })));
  const some = shown.filter(({ width, theme }) => `${width} ${theme}` === '390 dark' || `${width} ${theme}` === '1280 light');
  for (const { width, height, theme } of short ? some : shown) {
    await page.setViewportSize({ width, height });
    await page.emulateMedia({ colorScheme: theme });
    await person.settled();
    await at?.scrollIntoViewIfNeeded();
    if (settings.pictures) {
      mkdirSync(settings.pictures, { recursive: true });
      await page.screenshot({ path: join(settings.pictures, `${name}-${width}-${theme}.png`), caret: 'initial' });
    }
    for (const finding of [...(await findings(page)), ...(await page.evaluate(measured, width))]) {
      found.set(finding, [...(found.get(finding) ?? []), `${width} ${theme}`]);
    }
  }
  for (const [finding, where] of found) person.faults.push(`${name} (${where.join(', ')}): ${finding}`);
  await page.emulateMedia({ colorScheme: 'light' });
  await page.setViewportSize({ width: 1280, height: 800 });
}

/** Nothing lies beside the screen; of a phone not even within a part that scrolls, but for graphs. States are large. Runs in the page. */
function measured(width) {
  const beside = (one) => one.scrollWidth - one.clientWidth > 1;
  const out = beside(document.documentElement) ? ['some of it lies beside the screen'] : [];
  if ([...document.querySelectorAll('header nav')].some(beside)) out.push('the navigation lies beside its place');
  if (width < 500) {
    const pressed = 'button, summary, select, input:not([type=checkbox], [type=radio], [type=file]), .target';
    for (const one of document.querySelectorAll(`:is(header, main, dialog[open]) :is(${pressed})`)) {
      const { height } = one.getBoundingClientRect();
      if (one.checkVisibility() && height > 0 && height < 43.5) out.push(`it is ${Math.round(height)} px high, too small for a thumb: ${(one.getAttribute('aria-label') ?? one.textContent).trim().slice(0, 60)}`);
    }
    for (const one of document.querySelectorAll('main [role=region], dialog[open] [role=region]')) {
      if (beside(one) && !one.querySelector('.graph')) out.push(`it scrolls sideways: ${one.getAttribute('aria-label')}`);
    }
  }
  for (const one of document.querySelectorAll(':has(> svg:is(.calm, .stale, .stopped, .critical, .urgent, .warning)), .alarm')) {
    const size = parseFloat(getComputedStyle(one).fontSize);
    if (width >= 1280 && one.checkVisibility() && size < 24) out.push(`a state is written in ${size} px: ${one.textContent.trim().slice(0, 60)}`);
  }
  return out;
}

/** All rules of axe, WCAG 2.2's size of targets too, which it leaves out unless it is asked. Evaluated from outside, so the page's policy stays in force. */
async function findings(page) {
  if (!(await page.evaluate('typeof axe === "object"'))) await page.evaluate(axe);
  return page.evaluate(async () => {
    const { violations } = await axe.run(document, { resultTypes: ['violations'], rules: { 'target-size': { enabled: true } } });
    return violations.flatMap(({ id, help, nodes }) =>
      nodes.slice(0, 3).map((node) => `axe ${id}: ${help}: ${node.target.join(' ')} ${node.html.slice(0, 160)} ${node.failureSummary.replaceAll('\n', ' ').slice(0, 240)}`));
  });
}
