/** Of the whole page. */
import { session } from '../../lib/session.svelte';
import { Drafts } from './draft.svelte';

export const drafts = new Drafts(() => session.user);
