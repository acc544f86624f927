import type { Words } from '../en';

export const plan: Pick<Words, 'plan'> = {
  plan: {
    title: 'Prévision',
  },
};
