import type { Words } from '../en';

export const hall: Pick<Words, 'hall'> = {
  hall: {
    title: 'Hall',
    state: 'État',
    charge: 'Charge',
    task: 'Tâche',
    counts: 'Robots par état',
    map: 'Carte du hall avec {count} {count|robot|robots}. Le tableau montre les mêmes.',
    keys: 'Flèches : déplacer. + et − : zoom. 0 : tout. N, P : robot suivant, précédent. F : le suivre.',
    zoomIn: 'Agrandir',
    zoomOut: 'Réduire',
    all: 'Tout le hall',
    follow: 'Suivre',
    show: 'Montrer {robot} sur la carte',
    noPose: 'Sa position n’est pas connue',
    empty: 'Aucun robot ne convient.',
  },
};
