/** A scenario is drawn in the editor, as its operator does it: skills from the palette, forms, and lines between tasks. */
import { walk } from './keyboard.mjs';
import { look } from './look.mjs';
import { press } from './press.mjs';

/** Draws `file`, a scenario of `trb`; the editor stays open, and what is drawn says the same. */
export async function draw(olga, file) {
  const { page } = olga;
  await openEditor(olga);
  await look(olga, 'editor-empty');
  await drawAll(olga, file);
  await undoAndRedo(olga, file.tasks.length);
  await sameAs(olga, file);
  await page.waitForSelector('main :text("can run")');
  await look(olga, 'editor');
  await walk(olga);
}

export async function openEditor(olga) {
  await olga.go('#/scenarios');
  await olga.tabTo('main .tool-row button');
  await olga.page.keyboard.press('Enter');
  await olga.page.waitForSelector('main section.panel h2:has-text("Skills of the fleet")');
}

export async function drawAll(olga, file) {
  const { page } = olga;
  await fill(page.getByLabel('Name', { exact: true }), file.name);
  await fill(page.getByLabel('Description', { exact: true }), file.description);
  for (const [at, task] of file.tasks.entries()) await drawTask(olga, task, at);
}

/** `at`: how many are drawn already; the second one is dragged. */
export async function drawTask(olga, task, at) {
  const { page } = olga;
  const [first, ...others] = task.after ?? [];
  await choose(page, at === 0 ? null : (first ?? null));
  const skill = await found(page, task);
  if (at === 1) await dropOnGraph(page, skill);
  else await press(skill);
  const form = page.locator('section[aria-labelledby=task-form]');
  const id = form.getByLabel('Id', { exact: true });
  await id.waitFor();
  await fill(id, task.id);
  await form.locator(`h2:text-is("${task.id}")`).waitFor();
  for (const [name, value] of Object.entries(task.data ?? {})) await setParameter(form, name, value);
  for (const other of others) {
    if (task.when) await dragLine(page, form, other, task.id);
    else await form.getByLabel(other, { exact: true }).check();
  }
  if (task.when) await setCondition(form, task.when);
}

/** The task that the next one follows; nothing: none. */
async function choose(page, id) {
  const chosen = page.locator('.graph button[aria-pressed=true]');
  if (id === null && (await chosen.count()) > 0) await press(chosen);
  if (id !== null) {
    const box = boxOf(page, id);
    if ((await box.getAttribute('aria-pressed')) !== 'true') await press(box);
  }
}

const boxOf = (page, id) => page.locator('.graph button.task', { has: page.locator(`strong:text-is("${id}")`) });

/** The only one that is left by the filter. */
async function found(page, task) {
  await page.getByRole('searchbox', { name: 'Filter' }).fill(`${task.robot} ${task.skill}`);
  const item = page.getByRole('button', { name: `${task.skill} ${task.robot}`, exact: true });
  await page.waitForFunction(() => document.querySelectorAll('main button[draggable]').length === 1);
  return item;
}

/** Nothing may scroll between the press and the first move. */
// Who misses a list that still moves tries again.
async function dropOnGraph(page, skill) {
  const dropped = () => document.querySelectorAll('.graph button.task').length === 2;
  await page.evaluate(() => document.querySelector('main').scrollTo(0, 0));
  for (let tries = 1; ; ++tries) {
    await skill.hover();  // where the filter has left it
    await drag(page, skill, page.locator('.graph-scroll'));
    try {
      return await page.waitForFunction(dropped, null, {timeout: 5000});
    } catch (late) {
      if (tries === 3) throw late;
    }
  }
}

async function drag(page, one, to) {
  const [start, end] = [await one.boundingBox(), await to.boundingBox()];
  await page.mouse.move(start.x + start.width / 2, start.y + start.height / 2);
  await page.mouse.down();
  await page.mouse.move(end.x + end.width / 2, end.y + end.height / 2, { steps: 8 });
  await page.mouse.up();
}

/** From the handle of one box to the other box, with the mouse, until the form has the line, too. Who misses boxes that still move tries again. */
async function dragLine(page, form, from, to) {
  const handle = boxOf(page, from).locator('xpath=following-sibling::span[1]');
  const drawn = form.getByLabel(from, { exact: true }).and(page.locator(':checked'));
  for (let tries = 1; ; ++tries) {
    await handle.scrollIntoViewIfNeeded();
    await drag(page, handle, boxOf(page, to));
    try {
      return await drawn.waitFor({ timeout: 5000 });
    } catch (late) {
      if (tries === 3) throw late;
    }
  }
}

/** As somebody types: what a field has takes effect when it is left. */
async function fill(field, text) {
  await field.focus();
  await field.press('Control+a');
  await field.pressSequentially(text);
  await field.press('Tab');
}

async function setParameter(form, name, value) {
  const field = form.getByLabel(new RegExp(`^${name}( \\(.*\\))?( \\*)?$`));
  if ((await field.evaluate((one) => one.tagName)) === 'SELECT') await field.selectOption(String(value));
  else await fill(field, String(value));
}

async function setCondition(form, when) {
  await form.getByLabel('Only if a sensor says so').check();
  await fill(form.getByLabel('Sensor', { exact: true }), when.sensor);
  await form.getByLabel('Of the node').selectOption(when.of);
  await form.getByLabel('Comparison').selectOption(when.op);
  await fill(form.getByLabel('Value', { exact: true }), String(when.value));
  await fill(form.getByLabel('Unit', { exact: true }), when.unit);
}

/** By keys: the last step goes, and comes back. */
async function undoAndRedo(olga, count) {
  const { page } = olga;
  const text = () => page.getByRole('button', { name: 'As text' });
  const before = await page.locator('.graph button.task').allTextContents();
  await text().focus();
  await page.keyboard.press('Control+z');
  await page.waitForSelector('button:has-text("Redo"):enabled');
  await page.keyboard.press('Control+y');
  await page.waitForSelector('button:has-text("Redo"):disabled');
  const after = await page.locator('.graph button.task').allTextContents();
  if (after.length !== count || after.join() !== before.join()) throw new Error(`after undo and redo: ${after}`);
}

async function sameAs(olga, file) {
  const { page } = olga;
  await press(page.getByRole('button', { name: 'As text' }));
  const drawn = JSON.parse(await page.inputValue('#scenario-text'));
  await press(page.getByRole('button', { name: 'As a graph' }));
  if (sorted(drawn) !== sorted(file)) throw new Error(`drawn was ${JSON.stringify(drawn)}`);
}

/** The same text for the same content; comments are not drawn. */
function sorted(value) {
  if (Array.isArray(value)) return `[${value.map(sorted)}]`;
  if (typeof value !== 'object' || value === null) return JSON.stringify(value);
  return `{${Object.keys(value).filter((key) => key !== '_comment').sort().map((key) => `${key}:${sorted(value[key])}`)}}`;
}
