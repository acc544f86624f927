import type { LateWords } from '../en/late';
import { plan } from './plan_view';

export const late: LateWords = { ...plan };
