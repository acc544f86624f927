import type { Words } from '../en';

export const messages: Pick<Words, 'messages'> = {
  messages: {
    title: 'Messages',
    node: 'Nœud',
    type: 'Type',
    phase: 'Phase',
    all: 'tous',
    pause: 'Pause',
    goOn: 'Reprendre ({count} nouveaux)',
    none: 'Aucun message correspondant n’est encore passé.',
    leftOut: '{count} {count|message est venu trop vite pour être montré|messages sont venus trop vite pour être montrés}.',
    budget: 'Par phase',
    equation: 'Messages passés par ce nœud depuis son démarrage, par phase de l’équation 12 de l’article. Upkeep est ce que l’article ne compte pas.',
    count: 'Messages',
    share: 'Part',
  },
};
