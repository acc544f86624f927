/** Walks through a view with Tab: every control gets the focus, shows it, and lets it go again. */

const CONTROLS = 'a[href], button, input, select, textarea, summary, [tabindex], [contenteditable=true]';

export async function walk(person) {
  const { page } = person;
  const wanted = await page.evaluate(begin, CONTROLS);
  for (let presses = 0; presses < 3 * wanted + 50; presses++) {
    await page.keyboard.press('Tab');
    if (await page.evaluate(step)) {
      const faults = await page.evaluate(end);
      person.faults.push(...faults.map((fault) => `${person.name}, Tab in ${new URL(page.url()).hash}: ${fault}`));
      return wanted;
    }
  }
  const last = await page.evaluate(() => document.activeElement?.outerHTML.slice(0, 160));
  person.faults.push(`Tab in ${new URL(page.url()).hash} is trapped: ${last}`);
  return wanted;
}

/* The following run in the page. */

function begin(controls) {
  const isOfGroup = (one) => one.type === 'radio' && !one.checked && one.form === null
    && document.querySelector(`input[type=radio][name="${CSS.escape(one.name)}"]:checked`) !== null;
  const isReached = (one) => one.tabIndex >= 0 && !one.disabled && !one.closest('[inert]') && !isOfGroup(one)
    && one.checkVisibility({ visibilityProperty: true });
  const within = document.querySelector('dialog:modal') ?? document; // all else is inert
  const wanted = [...within.querySelectorAll(controls)].filter(isReached);
  document.activeElement?.blur();
  globalThis.tabWalk = { wanted, seen: new Set(), first: null, faults: [] };
  return wanted.length;
}

/** True: the walk has come round. */
async function step() {
  const walk = globalThis.tabWalk;
  const one = document.activeElement;
  if (one === null || one === document.body) return walk.seen.size > 0 && walk.wanted.every((wanted) => walk.seen.has(wanted) || !wanted.isConnected || wanted.disabled);
  if (walk.first === one) return true;
  walk.first ??= one;
  if (walk.seen.has(one)) return false;
  walk.seen.add(one);
  const style = getComputedStyle(one);
  const hasOutline = style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 1;
  if (!hasOutline && style.boxShadow === 'none') walk.faults.push(`the focus is not to be seen: ${one.outerHTML.slice(0, 160)}`);
  const clip = (value, most) => Math.min(Math.max(value, 1), most - 1);
  const box = () => one.getBoundingClientRect();
  const xs = () => [0.1, 0.5, 0.9].map((part) => clip(box().left + part * box().width, innerWidth));
  const ys = () => [0.1, 0.5, 0.9].map((part) => clip(box().top + part * box().height, innerHeight));
  const isAt = (x, y) => {
    const top = document.elementFromPoint(x, y);
    return top !== null && (one.contains(top) || top.contains(one) && top.tagName === 'LABEL');
  };
  const isSeen = () => xs().some((x) => ys().some((y) => isAt(x, y)));
  // What scrolls into sight is there with the next picture.
  const picture = () => new Promise((done) => requestAnimationFrame(done));
  for (let i = 0; i < 3 && !isSeen(); i++) await picture();
  if (!isSeen()) {
    const above = document.elementFromPoint(xs()[1], ys()[1])?.outerHTML.slice(0, 100);
    walk.faults.push(`what has the focus lies behind something: ${one.outerHTML.slice(0, 160)} at ${Math.round(box().x)},${Math.round(box().y)}: ${above}`);
  }
  return false;
}

function end() {
  const { wanted, seen, faults } = globalThis.tabWalk;
  const missed = wanted.filter((one) => one.isConnected && !one.disabled && !seen.has(one)); // what is disabled meanwhile takes no focus
  return [...faults, ...missed.map((one) => `never gets the focus: ${one.outerHTML.slice(0, 160)}`)];
}
