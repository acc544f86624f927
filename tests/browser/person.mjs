/** Somebody at the page: a browser's window of his own, in which every fault of the page is noted. */
import { createRequire } from 'node:module';

export const require = createRequire(new URL('../../services/cloud-gateway/web/', import.meta.url));
const { chromium } = require('playwright-core');

// Debian's Chromium has a sandbox, which root cannot use.
const sandbox = process.getuid() === 0 ? ['--no-sandbox'] : [];
const quiet = ['--disable-gpu', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];

export const startBrowser = () => chromium.launch({ executablePath: '/usr/bin/chromium', args: [...sandbox, ...quiet] });

export class Person {
  faults = [];
  /** What a story brings about on purpose, such as a refused sign-in: patterns of the console's words. */
  expected = [];

  static async arrive(browser, settings, name, more = {}) {
    const person = new Person();
    person.name = name;
    person.settings = settings;
    person.context = await browser.newContext({ ignoreHTTPSErrors: true, locale: 'en-GB', viewport: { width: 1280, height: 800 }, ...more });
    person.context.setDefaultTimeout(60000);
    person.page = await person.context.newPage();
    person.watch();
    await person.page.goto(settings.url);
    return person;
  }

  watch() {
    const { origin, host } = new URL(this.settings.url);
    const page = this.page;
    page.on('pageerror', (error) => this.note(`not caught: ${error.stack ?? error}`));
    page.on('console', (line) => {
      if (line.type() === 'error' || line.type() === 'warning') this.note(`console: ${line.text()} ${line.location().url}`);
    });
    page.on('request', (request) => {
      if (new URL(request.url()).origin !== origin) this.note(`asks another origin: ${request.url()}`);
    });
    page.on('websocket', (socket) => {
      if (new URL(socket.url()).host !== host) this.note(`asks another origin: ${socket.url()}`);
    });
  }

  note(fault) {
    if (!this.expected.some((pattern) => pattern.test(fault))) this.faults.push(`${this.name}, ${new URL(this.page.url()).hash}: ${fault}`);
  }

  /** By keyboard alone: the page has put nothing into the fields, and Tab finds them. */
  async signIn(password = this.settings.password) {
    await this.page.waitForSelector('input[autocomplete=username]');
    await this.tabTo('input[autocomplete=username]');
    await this.page.keyboard.press('Control+a');
    await this.page.keyboard.type(this.name);
    await this.tabTo('input[type=password]');
    await this.page.keyboard.type(password);
    await this.page.keyboard.press('Enter');
  }

  async enter() {
    await this.signIn();
    await this.page.waitForSelector('nav');
    await this.page.waitForSelector('.connection:not(.lost)', { state: 'attached' });
  }

  /** Presses Tab until what fits has the focus. */
  async tabTo(selector, most = 150) {
    for (let i = 0; i < most; i++) {
      if (await this.page.evaluate((wanted) => document.activeElement?.matches(wanted) ?? false, selector)) return;
      await this.page.keyboard.press('Tab');
    }
    throw new Error(`${most} times Tab do not lead to ${selector}`);
  }

  async go(hash) {
    await this.page.evaluate((to) => new Promise((done) => { // until the page has heard of it: the view before has a heading, too
      const before = location.hash;
      addEventListener('hashchange', () => requestAnimationFrame(done), { once: true });
      location.hash = to;
      if (location.hash === before) done();
    }), hash);
    await this.page.waitForSelector('main h1');
    await this.settled();
  }

  /** Until nothing more is loaded, by the page's own word too, and two pictures have been drawn. */
  async settled() {
    await this.page.waitForFunction(isLoaded).catch((error) => {
      throw new Error(`${new URL(this.page.url()).hash} is still being loaded`, { cause: error });
    });
    await this.drawn();
  }

  /** Until two pictures have been drawn, whatever is still being loaded. */
  async drawn() {
    await this.page.waitForLoadState('networkidle', { timeout: 15000 }).catch(() => undefined);
    await this.page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  }

  /** Addresses of the views: of the navigation, of the menu, and the page of colours and sizes, to which nothing leads. */
  async listed() {
    await this.openMenu();
    const all = await this.page.$$eval('nav a', (links) => links.map((link) => link.getAttribute('href')));
    await this.page.keyboard.press('Escape');
    await this.page.waitForSelector('dialog[open]', { state: 'detached' });
    return [...all, '#/design'];
  }

  async openMenu() {
    await this.page.click('header button:has-text("▾")');
    await this.page.waitForSelector('dialog[open] nav');
  }

  /** What there is of which the page has a list that leads to each. */
  async kinds() {
    return this.page.evaluate(async () => {
      const there = async (path, key) => (await (await fetch(`/api/v1/${path}`)).json())[key].length > 0;
      const lists = { robots: there('robots', 'items'), runs: there('archive', 'runs'), alerts: there('alerts', 'items'), scenarios: there('scenarios', 'items') };
      const all = await Promise.all(Object.entries(lists).map(async ([kind, is]) => ((await is) ? [kind] : [])));
      return all.flat();
    });
  }

  /** Addresses below a view, as what is shown leads to them. */
  async details() {
    const links = await this.page.$$eval('main a[href^="#/"]', (all) => all.map((link) => link.getAttribute('href')));
    return links.filter((link) => link.split('/').length > 2);
  }
}

/** Nothing says that it is being loaded, but for a sensor's value or picture, which may never come. Runs in the page. */
function isLoaded() {
  const texts = document.createTreeWalker(document.querySelector('main') ?? document.createElement('p'), NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const { data, parentElement } = texts.currentNode;
    if (/^(Loading|Chargement) …$/.test(data.trim()) && !parentElement.closest('.value, figure')) return false;
  }
  return true;
}
