import type { Words } from '../en';

export const users: Pick<Words, 'users'> = {
  users: {
    title: 'Utilisateurs',
    all: 'Qui peut se connecter',
    name: 'Nom',
    role: 'Rôle',
    roleOf: 'Rôle de {name}',
    viewer: 'observateur',
    operator: 'opérateur',
    admin: 'administrateur',
    since: 'Depuis',
    orders: 'Ordres',
    password: 'Mot de passe',
    passwordHint: '12 caractères au moins',
    newPassword: 'Nouveau mot de passe',
    disabled: 'bloqué',
    disable: 'Bloquer',
    enable: 'Débloquer',
    delete: 'Supprimer',
    create: 'Ajouter un utilisateur',
    done: 'Fait',
    signsOut: 'Cette personne est déconnectée partout.',
  },
};
