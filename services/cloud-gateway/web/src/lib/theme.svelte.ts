/** Dark or light: as the system has it, or as the person chose. */
export type Theme = 'system' | 'light' | 'dark';

const KEPT = 'trb.theme';
const isDark = matchMedia('(prefers-color-scheme: dark)');

class ThemeStore {
  chosen = $state<Theme>(first());
  shown = $state<'light' | 'dark'>('light');

  constructor() {
    isDark.addEventListener('change', () => this.apply());
    this.apply();
  }

  choose(theme: Theme): void {
    this.chosen = theme;
    localStorage.setItem(KEPT, theme);
    this.apply();
  }

  private apply(): void {
    this.shown = this.chosen === 'system' ? (isDark.matches ? 'dark' : 'light') : this.chosen;
    document.documentElement.dataset.theme = this.shown;
  }
}

function first(): Theme {
  const kept = localStorage.getItem(KEPT);
  return kept === 'light' || kept === 'dark' ? kept : 'system';
}

export const theme = new ThemeStore();
