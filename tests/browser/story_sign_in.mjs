import { look } from './look.mjs';
import { Person } from './person.mjs';

export async function signsIn(browser, settings, people) {
  const olga = await Person.arrive(browser, settings, 'olga');
  people.push(olga);
  await olga.page.waitForSelector('form');
  await look(olga, 'sign-in');
  olga.expected.push(/status of 401 .*\/api\/v1\/session$/);
  await olga.signIn('a wrong password');
  const said = await olga.page.waitForSelector('[role=alert]:has-text("wrong")');
  await olga.page.waitForFunction((one) => document.activeElement === one, said);
  olga.expected.pop();
  await olga.enter();
}
