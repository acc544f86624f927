import type { Words } from '../en';

export const about: Pick<Words, 'about'> = {
  about: {
    title: 'À propos',
    node: 'Nœud',
    nodes: 'Nœuds',
    services: 'Services du nœud de la passerelle',
    address: 'Adresse',
    via: 'Par',
    certificateEnds: 'Fin du certificat',
    licences: 'Licences',
    licencesHow: 'Ce que d’autres ont écrit de cette page. Les composants des programmes sont dans les nomenclatures des paquets.',
    licence: 'Licence',
    api: 'L’API (OpenAPI 3.1)',
  },
};
