import type { Words } from '../en';

export const audit: Pick<Words, 'audit'> = {
  audit: {
    title: 'Audit',
    head: 'La chaîne',
    covered: '{number} {number|enregistrement|enregistrements} ; la tête signée du nœud en couvre {signed}.',
    export: 'Exporter le journal',
    exportHow: 'Qui a la clé publique de la flotte le vérifie : trb audit verify',
    records: 'Enregistrements',
    number: 'Numéro',
    who: 'Qui',
    nobody: 'personne',
    action: 'Quoi',
    about: 'À propos',
    outcome: 'Issue',
    from: 'D’où',
    older: 'Enregistrements plus anciens',
  },
};
