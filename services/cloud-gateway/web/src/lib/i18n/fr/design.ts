import type { Words } from '../en';

export const design: Pick<Words, 'design'> = {
  design: {
    title: 'Éléments de style',
    colours: 'Couleurs',
    type: 'Caractères',
    states: 'États',
    controls: 'Commandes',
    sample: 'Le robot 7 est au convoyeur : 1 234,5 kg',
    spacing: 'Espacements',
  },
};
