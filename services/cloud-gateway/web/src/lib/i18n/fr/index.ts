/** Tous les mots de la page en français. */
import type { Words } from '../en';
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

export const fr: Words = {
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
