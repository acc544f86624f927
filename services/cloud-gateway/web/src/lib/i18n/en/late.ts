/** Words that come with their view: nobody waits for them who does not open it. */
import { plan } from './plan_view';

export const late = { ...plan };

export type LateWords = { [Section in keyof typeof late]: { [Key in keyof (typeof late)[Section]]: string } };
