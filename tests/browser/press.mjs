/** Presses Enter on a button or a link, as soon as it may be used: a press on one that is still disabled is lost. */
export const press = (where, options) => where.and(where.page().locator(':not(:disabled)')).press('Enter', options);
