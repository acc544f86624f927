import type { Words } from '../en';

export const sensors: Pick<Words, 'sensors'> = {
  sensors: {
    title: 'Capteurs',
    none: 'Aucun capteur n’est branché.',
    silent: 'Sans nouvelles du routeur : on ne sait pas quels capteurs il y a, ni comment ils vont.',
    sensor: 'Capteur',
    kind: 'Genre',
    unit: 'Unité',
    device: 'Appareil',
    away: 'silencieux',
    gone: 'La flotte n’a plus ce capteur : il est débranché, ou son adresse est fausse.',
    value: 'Valeur',
    window: 'Affiché',
    minute: '1 minute',
    tenMinutes: '10 minutes',
    hour: '1 heure',
    day: '1 jour',
    least: 'Minimum',
    most: 'Maximum',
    mean: 'Moyenne',
    part: 'Des valeurs depuis',
    csv: 'Télécharger ce qui est enregistré (CSV, les 100 000 dernières)',
    picture: 'Ce que voit {sensor} de {node}',
    noPicture: 'Aucune image n’arrive.',
    pictureAge: 'L’image date de {age}.',
  },
};
