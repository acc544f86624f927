export const about = {
  about: {
    title: 'About',
    node: 'Node',
    nodes: 'Nodes',
    services: 'Services of the gateway’s node',
    address: 'Address',
    via: 'By way of',
    certificateEnds: 'Certificate ends',
    licences: 'Licences',
    licencesHow: 'What others wrote of this page. The programs’ parts are in the packages’ bills of materials.',
    licence: 'Licence',
    api: 'The API (OpenAPI 3.1)',
  },
};
