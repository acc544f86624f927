/** What of others is in the built page; licences.test.ts holds it against the lock file and against what is imported. */
export interface Part {
  name: string;
  version: string;
  licence: string;
}

export const parts: Part[] = [
  { name: 'svelte', version: '5.57.3', licence: 'MIT' },
  { name: 'uplot', version: '1.6.32', licence: 'MIT' },
  { name: 'esm-env', version: '1.2.2', licence: 'MIT' },
  { name: 'clsx', version: '2.1.1', licence: 'MIT' },
];
