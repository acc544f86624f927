import type { Words } from '../en';

export const access: Pick<Words, 'access'> = {
  access: {
    title: 'Accès',
    all: 'Jetons des programmes',
    none: 'Aucun programme n’a de jeton.',
    create: 'Créer un jeton',
    once: 'Le jeton {name} n’est montré que cette fois',
    copy: 'Copier',
    copied: 'Copié',
    hide: 'Je l’ai conservé',
    readOnly: 'lecture seule',
    madeBy: 'Créé par',
    ends: 'Expire',
    revoke: 'Révoquer',
    askRevoke: 'Le programme qui l’utilise est désormais refusé.',
    nameHint: 'Du programme qui le reçoit',
    days: 'Jours',
    daysHint: '1 à 365',
  },
};
