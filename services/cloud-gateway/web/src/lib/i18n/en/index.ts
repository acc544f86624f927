/** All words of the page in English. `{name}` is filled in. A file for each view, with its sections; fr has the same keys. */
import type { LateWords } from './late';
import { about } from './about';
import { access } from './access';
import { alerts } from './alerts';
import { audit } from './audit';
import { control } from './control';
import { hall } from './hall';
import { messages } from './messages';
import { plan } from './plan';
import { robot } from './robot';
import { runs } from './runs';
import { scenarios } from './scenarios';
import { sensors } from './sensors';
import { settings } from './settings';
import { shell } from './shell';
import { states } from './states';
import { design } from './design';
import { users } from './users';

export const en = {
  ...shell,
  ...states,
  ...design,
  ...hall,
  ...robot,
  ...alerts,
  ...runs,
  ...plan,
  ...scenarios,
  ...users,
  ...settings,
  ...access,
  ...audit,
  ...messages,
  ...about,
  ...control,
  ...sensors,
};

/** The same keys, other words. */
export type Words = { [Section in keyof typeof en]: { [Key in keyof (typeof en)[Section]]: string } };
type KeysOf<All> = { [Section in keyof All & string]: `${Section}.${Extract<keyof All[Section], string>}` }[keyof All & string];
export type Key = KeysOf<Words> | KeysOf<LateWords>;
