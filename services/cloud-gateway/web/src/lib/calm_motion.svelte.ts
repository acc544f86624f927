/** Whether the person has asked his system for less motion. */
const query = matchMedia('(prefers-reduced-motion: reduce)');

class CalmMotion {
  isWanted = $state(query.matches);

  constructor() {
    query.addEventListener('change', () => (this.isWanted = query.matches));
  }
}

export const calmMotion = new CalmMotion();
