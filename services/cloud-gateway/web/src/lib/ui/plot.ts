import type uPlot from 'uplot';

/** What a chart is drawn with: the page's own size of type, its colours, and an axis in both. */
export interface Pen {
  rem: number;
  colour: (name: string) => () => string;
  axis: uPlot.Axis & { font: string };
}
